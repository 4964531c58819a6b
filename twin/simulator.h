// SPDX-License-Identifier: Apache-2.0
// The simulator of one spring-mass system, frame by frame, and its adjoint. A frame has `substeps`
// sub-steps of h = frame_time / substeps. In each, the controllers go to their place at its end
// (linear within the frame), and the level makes its step (level_step.h).
// The adjoint of a frame recomputes the frame from its first state (the checkpoint) and goes
// through its sub-steps backwards; memory is one frame, whatever the length of the rollout.
#ifndef PHYSPRING_TWIN_SIMULATOR_H_
#define PHYSPRING_TWIN_SIMULATOR_H_

#include <optional>
#include <vector>

#include "twin/environment.h"
#include "twin/grasp_springs.h"
#include "twin/kernel_choice.h"
#include "twin/level_step.h"
#include "twin/node_state.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

template <class Real>
class LaneSimulator;

struct SimulationOptions {
  double frame_time = 1.0 / 30;     // s
  int substeps = 667;               // a frame
  bool controller_velocity = true;  // dashpots feel the controllers' velocity (false: PhysTwin)
  ControllerMask late = {};         // all that may take hold within a motion
};

// The input of a frame: where the controllers are at its start and its end (3 x controllers, m),
// and the geoms around.
struct FrameInput {
  Points controllers_start, controllers_end;
  std::vector<Geom> geoms;
  double time = 0;          // at its start, since the start of the recording, s
  ControllerMask released;  // hold nothing in the frame: their springs are not there
  Attachment attached;      // takes hold at its start
  // How fast controllers_start and controllers_end change with a delay of the controllers (m/s,
  // recorded_input.h); only its derivative needs it.
  Points delay_rate_start = Points(3, 0), delay_rate_end = Points(3, 0);
};

template <class Real>
class Simulator {
 public:
  using State = NodeStates<Real>;

  Simulator(const SpringMassSystem& system, const Environment& environment,
            const SimulationOptions& options, const Kernel<Real>& kernel = BestKernel<Real>());

  // The parameters, masses, drag and effects of a system of the same topology and effects.
  void SetParameters(const SpringMassSystem& system);

  // State of free nodes at `position` and `velocity` (3 x nodes).
  State MakeState(const Points& position, const Points& velocity) const;
  Points Positions(const State& state) const;   // where the free nodes are, 3 x nodes, m
  Points Velocities(const State& state) const;  // 3 x nodes, m/s
  // Of the springs as effects and late grasps made them, (springs), m.
  Eigen::VectorXd RestLengths(const State& state) const;

  // Buffers of a frame; one a thread.
  class Workspace;

  // Advances the state by one frame. The controllers' entries are those of the frame's end, too.
  void AdvanceFrame(const FrameInput& input, State* state, Workspace* workspace) const;

  // Adjoint of AdvanceFrame. `start`: the state before the frame. `state_bar`: in d loss / d state
  // after the frame, out before it. Adds to `gradient`. Goes through the frame again, forwards.
  void AdvanceFrameAdjoint(const State& start, const FrameInput& input, State* state_bar,
                           SystemGradient* gradient, Workspace* workspace) const;

  // The same in two parts, for a frame whose adjoint follows at once: AdvanceFrame, keeping what
  // the adjoint needs in the workspace, and the adjoint of the frame that was recorded last.
  void RecordFrame(const FrameInput& input, State* state, Workspace* workspace) const;
  void RecordedFrameAdjoint(State* state_bar, SystemGradient* gradient, Workspace* workspace) const;

  const SimulationOptions& options() const { return options_; }
  int node_count() const { return nodes_; }

 private:
  friend class LaneSimulator<Real>;

  // That of the frame for which the workspace was started.
  const LevelStep<Real>& StepOf(const Workspace& workspace) const;
  int state_size() const { return step_.state_size() + grasps_.records(); }
  LevelSubstep<Real> NowOf(const FrameInput& input, int substep, const Workspace& workspace) const;
  void StartFrame(const FrameInput& input, State* state, Workspace* workspace) const;
  void EndFrame(const FrameInput& input, const Workspace& workspace, State* state) const;
  void PlaceControllers(const FrameInput& input, int substep, State* state) const;
  void Substep(const FrameInput& input, int substep, State* state, State* next,
               typename LevelStep<Real>::Impacts* impacts, Workspace* workspace) const;
  void SubstepAdjoint(int substep, State* state_bar, Workspace* workspace) const;

  int nodes_, controllers_;
  SimulationOptions options_;
  double h_;  // s
  LevelStep<Real> step_;
  GraspSprings<Real> grasps_;
  NodeStep<Real> node_step_;
};

template <class Real>
class Simulator<Real>::Workspace {
 public:
  explicit Workspace(const Simulator& simulator)
      : next(simulator.state_size()), start(next), buffers(simulator.step_.springs()) {}

  // d loss / d the controllers of the frame whose adjoint was worked out last, 3 x controllers: at
  // its start, at its end. That a grasp takes hold is taken as given.
  const Points& controllers_start_bar() const { return controllers_start_bar_; }
  const Points& controllers_end_bar() const { return controllers_end_bar_; }

 private:
  friend class Simulator;
  friend class LaneSimulator<Real>;

  State next;
  State start;                              // of the frame, if it has a step of its own
  std::optional<LevelStep<Real>> own_step;  // where controllers let go and take hold
  std::vector<State> states;  // at the start of each sub-step of a frame, and at its end
  std::vector<typename LevelStep<Real>::Impacts> impacts;  // one for each sub-step
  LevelBuffers<Real> buffers;
  typename Contact<Real>::Pairs pairs;  // the pairs of the frame
  Points controller_velocity;           // 3 x controllers, m/s, in the frame
  FrameInput input;                     // what moved the frame that was recorded last
  Points controllers_start_bar_, controllers_end_bar_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SIMULATOR_H_
