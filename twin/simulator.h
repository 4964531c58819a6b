// SPDX-License-Identifier: Apache-2.0
// The simulator of one spring-mass system, frame by frame, and its adjoint. A frame has `substeps`
// sub-steps of h = frame_time / substeps; each is semi-implicit Euler:
//   controllers to their place at the end of the sub-step (linear within the frame)
//   F   springs and dashpots at (x, v)                                 spring_force.h
//       and the system's effects, if it has any                        effects/effect.h
//   v*  = (v + h (F / m + g)) exp(-h drag)                             node_update.h
//   v'  = contacts(v*)                                                 contact.h
//   x'  = x + h v'                                                     node_update.h
// The adjoint of a frame recomputes the frame from its first state (the checkpoint) and goes
// through its sub-steps backwards; memory is one frame, whatever the length of the rollout.
#ifndef PHYSPRING_TWIN_SIMULATOR_H_
#define PHYSPRING_TWIN_SIMULATOR_H_

#include <memory>
#include <vector>

#include "twin/contact.h"
#include "twin/effects/effect_step.h"
#include "twin/environment.h"
#include "twin/kernel_choice.h"
#include "twin/node_state.h"
#include "twin/spring_blocks.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

struct SimulationOptions {
  double frame_time = 1.0 / 30;     // s
  int substeps = 667;               // a frame
  bool controller_velocity = true;  // dashpots feel the controllers' velocity (false: PhysTwin)
};

// The input of a frame: where the controllers are at its start and its end (3 x controllers, m),
// and the geoms around.
struct FrameInput {
  Points controllers_start, controllers_end;
  std::vector<Geom> geoms;
  double time = 0;  // at its start, since the start of the recording, s
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
  Points Positions(const State& state) const;   // of the free nodes, 3 x nodes, m
  Points Velocities(const State& state) const;  // 3 x nodes, m/s

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
  void SetControllerVelocity(const FrameInput& input, Workspace* workspace) const;
  void PlaceControllers(const FrameInput& input, int substep, State* state) const;
  void Substep(const FrameInput& input, const typename Contact<Real>::Pairs& pairs, int substep,
               State* state, State* next, typename Contact<Real>::Impacts* impacts,
               Workspace* workspace) const;
  void SubstepAdjoint(int substep, State* state_bar, Workspace* workspace) const;
  void AddGradients(const Workspace& workspace, SystemGradient* gradient) const;

  void SetParameters(const SpringMassSystem& system, const Eigen::Vector3d& gravity);
  int state_size() const {
    return springs_.spare_node + 1 + (effects_ ? effects_->extra_records() : 0);
  }
  EffectSubstep<Real> NowOf(double start, int substep, const State& state,
                            const Points& controller_velocity) const {
    const double h = options_.frame_time / options_.substeps;
    return {*kernel_, springs_.View(), start + substep * h, h, state, controller_velocity};
  }

  NodeView<Real> Nodes() const { return {nodes_, h_over_mass_.data(), h_, decay_, kick_}; }

  NodeForce<Real> kick_;  // h g
  const Kernel<Real>* kernel_;
  int nodes_, controllers_;
  SimulationOptions options_;
  Real h_;
  Real decay_ = 1;  // exp(-h drag)
  std::vector<Real> h_over_mass_;
  SpringBlocks<Real> springs_;
  Contact<Real> contact_;
  Eigen::Vector3d gravity_;                          // of the environment, m/s^2
  std::shared_ptr<const EffectStep<Real>> effects_;  // null for a system without effects
};

template <class Real>
class Simulator<Real>::Workspace {
 public:
  explicit Workspace(const Simulator& simulator);

 private:
  friend class Simulator;
  void ClearGradients(int nodes);

  State next;
  NodeForces<Real> force;
  std::vector<State> states;  // at the start of each sub-step of a frame, and at its end
  std::vector<typename Contact<Real>::Impacts> impacts;  // of each sub-step

  // Sums over the sub-steps of a frame.
  SpringBlockGradient<Real> spring_gradient;
  NodeForces<Real> mass_gradient;  // this, drag and gravity: see node_update.h
  NodeForce<Real> drag_gradient, gravity_gradient;
  ContactGradient<Real> contact_gradient;

  EffectBuffers<Real> effects;
  Points controller_velocity;  // 3 x controllers, m/s, in the frame; only effects need it
  FrameInput input;            // of the frame that was recorded last; only effects need it
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SIMULATOR_H_
