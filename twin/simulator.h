// SPDX-License-Identifier: Apache-2.0
// The simulator of one spring-mass system, frame by frame, and its adjoint. A frame has `substeps`
// sub-steps of h = frame_time / substeps; each is semi-implicit Euler:
//   controllers to their place at the end of the sub-step (linear within the frame)
//   F   springs and dashpots at (x, v)                                 spring_force.h
//   v*  = (v + h (F / m + g)) exp(-h drag)                             node_update.h
//   v'  = contacts(v*)                                                 contact.h
//   x'  = x + h v'                                                     node_update.h
// The adjoint of a frame recomputes the frame from its first state (the checkpoint) and goes
// through its sub-steps backwards; memory is one frame, whatever the length of the rollout.
#ifndef PHYSPRING_TWIN_SIMULATOR_H_
#define PHYSPRING_TWIN_SIMULATOR_H_

#include <vector>

#include "twin/contact.h"
#include "twin/environment.h"
#include "twin/kernel_choice.h"
#include "twin/node_state.h"
#include "twin/spring_blocks.h"
#include "twin/spring_mass_system.h"

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
};

// Derivatives of a loss with respect to everything learnable. Shapes as in SpringMassSystem.
struct SystemGradient {
  Eigen::VectorXd stiffness, rest_length, dashpot;  // (springs)
  Eigen::VectorXd mass;                             // (nodes)
  double drag = 0;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  ContactLaws<double> contact;  // surface and object restitution and friction

  explicit SystemGradient(const SpringMassSystem& system);
  SystemGradient& operator+=(const SystemGradient& other);
};

template <class Real>
class Simulator {
 public:
  using State = NodeStates<Real>;

  Simulator(const SpringMassSystem& system, const Environment& environment,
            const SimulationOptions& options, const Kernel<Real>& kernel = BestKernel<Real>());

  // The parameters, masses and drag of a system of the same topology.
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
  void PlaceControllers(const FrameInput& input, int substep, State* state) const;
  void Substep(const FrameInput& input, const typename Contact<Real>::Pairs& pairs, int substep,
               State* state, State* next, typename Contact<Real>::Impacts* impacts,
               NodeForces<Real>* force) const;
  void SubstepAdjoint(int substep, State* state_bar, Workspace* workspace) const;
  void AddGradients(const Workspace& workspace, SystemGradient* gradient) const;

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
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SIMULATOR_H_
