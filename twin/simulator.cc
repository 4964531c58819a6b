// SPDX-License-Identifier: Apache-2.0
#include "twin/simulator.h"

#include <algorithm>
#include <cmath>

namespace physpring {

template <class Real>
Simulator<Real>::Simulator(const SpringMassSystem& system, const Environment& environment,
                           const SimulationOptions& options, const Kernel<Real>& kernel)
    : kernel_(&kernel),
      nodes_(system.node_count()),
      controllers_(system.controllers),
      options_(options),
      h_(static_cast<Real>(options.frame_time / options.substeps)),
      springs_(system),
      contact_(system, environment),
      gravity_(environment.gravity) {
  SetParameters(system);
}

template <class Real>
void Simulator<Real>::SetParameters(const SpringMassSystem& system) {
  if (system.effects.empty()) {
    SetParameters(system, gravity_);
    return;
  }
  effects_ = std::make_shared<const EffectStep<Real>>(system, gravity_, springs_.size());
  SetParameters(effects_->changed().system, effects_->changed().gravity);
}

template <class Real>
void Simulator<Real>::SetParameters(const SpringMassSystem& system,
                                    const Eigen::Vector3d& gravity) {
  for (int j = 0; j < 3; ++j) kick_.f[j] = h_ * static_cast<Real>(gravity[j]);
  springs_.SetParameters(system);
  contact_.SetParameters(system);
  decay_ = static_cast<Real>(std::exp(-options_.frame_time / options_.substeps * system.drag));
  h_over_mass_.resize(nodes_);
  for (int i = 0; i < nodes_; ++i) h_over_mass_[i] = h_ * static_cast<Real>(1 / system.mass[i]);
}

template <class Real>
typename Simulator<Real>::State Simulator<Real>::MakeState(const Points& position,
                                                           const Points& velocity) const {
  State state(state_size());
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) {
      state[i].x[j] = static_cast<Real>(position(j, i));
      state[i].v[j] = static_cast<Real>(velocity(j, i));
    }
  }
  return state;
}

template <class Real>
Points Simulator<Real>::Positions(const State& state) const {
  Points position(3, nodes_);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) position(j, i) = static_cast<double>(state[i].x[j]);
  }
  return position;
}

template <class Real>
Points Simulator<Real>::Velocities(const State& state) const {
  Points velocity(3, nodes_);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) velocity(j, i) = static_cast<double>(state[i].v[j]);
  }
  return velocity;
}

template <class Real>
Simulator<Real>::Workspace::Workspace(const Simulator& simulator)
    : next(simulator.state_size()),
      force(simulator.springs_.spare_node + 1),
      spring_gradient(simulator.springs_.size()) {}

template <class Real>
void Simulator<Real>::PlaceControllers(const FrameInput& input, int substep, State* state) const {
  const double fraction = static_cast<double>(substep + 1) / options_.substeps;
  for (int c = 0; c < controllers_; ++c) {
    NodeState<Real>& controller = (*state)[nodes_ + c];
    for (int j = 0; j < 3; ++j) {
      const double from = input.controllers_start(j, c), to = input.controllers_end(j, c);
      controller.x[j] = static_cast<Real>(from + (to - from) * fraction);
      controller.v[j] =
          options_.controller_velocity ? static_cast<Real>((to - from) / options_.frame_time) : 0;
    }
  }
}

template <class Real>
void Simulator<Real>::SetControllerVelocity(const FrameInput& input, Workspace* workspace) const {
  if (!effects_) return;
  workspace->controller_velocity =
      (input.controllers_end - input.controllers_start) / options_.frame_time;
}

template <class Real>
void Simulator<Real>::Substep(const FrameInput& input, const typename Contact<Real>::Pairs& pairs,
                              int substep, State* state, State* next,
                              typename Contact<Real>::Impacts* impacts,
                              Workspace* workspace) const {
  PlaceControllers(input, substep, state);
  NodeForces<Real>& force = workspace->force;
  std::fill(force.begin(), force.end(), NodeForce<Real>{});
  if (effects_) {
    effects_->AddForces(NowOf(input.time, substep, *state, workspace->controller_velocity), next,
                        &force, &workspace->effects);
  } else {
    kernel_->add_spring_forces(springs_.View(), state->data(), force.data());
  }
  const double h = options_.frame_time / options_.substeps;
  kernel_->update_velocities(Nodes(), state->data(), force.data(), next->data());
  contact_.Apply(*state, pairs, input.geoms, substep * h, h, next, impacts);
  kernel_->update_positions(Nodes(), state->data(), next->data());
}

template <class Real>
void Simulator<Real>::SubstepAdjoint(int substep, State* state_bar, Workspace* workspace) const {
  const State& state = workspace->states[substep];
  State& next = workspace->states[substep + 1];
  typename Contact<Real>::Impacts& impacts = workspace->impacts[substep];
  kernel_->update_positions_adjoint(Nodes(), state_bar->data());
  contact_.ApplyAdjoint(state, &impacts, state_bar, &workspace->contact_gradient);
  contact_.Undo(impacts, &next);
  kernel_->update_velocities_adjoint(
      Nodes(), state.data(), next.data(), state_bar->data(), workspace->force.data(),
      {workspace->mass_gradient.data(), &workspace->drag_gradient, &workspace->gravity_gradient});
  if (!effects_) {
    kernel_->add_spring_forces_adjoint(springs_.View(), state.data(), workspace->force.data(),
                                       state_bar->data(), workspace->spring_gradient.View());
    return;
  }
  effects_->AddForcesAdjoint(
      NowOf(workspace->input.time, substep, state, workspace->controller_velocity),
      workspace->force, state_bar, workspace->spring_gradient.View(), &workspace->effects);
  effects_->TakeControllers(static_cast<double>(substep + 1) / options_.substeps,
                            options_.controller_velocity ? options_.frame_time : 0, state_bar,
                            &workspace->effects);
}

template <class Real>
void Simulator<Real>::AdvanceFrame(const FrameInput& input, State* state,
                                   Workspace* workspace) const {
  const auto pairs = contact_.FindPairs(*state, options_.frame_time);
  SetControllerVelocity(input, workspace);
  if (workspace->impacts.empty()) workspace->impacts.resize(1);
  for (int i = 0; i < options_.substeps; ++i) {
    Substep(input, pairs, i, state, &workspace->next, &workspace->impacts[0], workspace);
    std::swap(*state, workspace->next);
  }
  PlaceControllers(input, options_.substeps - 1, state);
}

template <class Real>
void Simulator<Real>::AdvanceFrameAdjoint(const State& start, const FrameInput& input,
                                          State* state_bar, SystemGradient* gradient,
                                          Workspace* workspace) const {
  State state = start;
  RecordFrame(input, &state, workspace);
  RecordedFrameAdjoint(state_bar, gradient, workspace);
}

template <class Real>
void Simulator<Real>::RecordFrame(const FrameInput& input, State* state,
                                  Workspace* workspace) const {
  const auto pairs = contact_.FindPairs(*state, options_.frame_time);
  SetControllerVelocity(input, workspace);
  workspace->states.resize(options_.substeps + 1, State(state->size()));
  workspace->impacts.resize(options_.substeps);
  workspace->states[0] = *state;
  for (int i = 0; i < options_.substeps; ++i) {
    Substep(input, pairs, i, &workspace->states[i], &workspace->states[i + 1],
            &workspace->impacts[i], workspace);
  }
  if (effects_) workspace->input = input;
  *state = workspace->states[options_.substeps];
  PlaceControllers(input, options_.substeps - 1, state);
}

template <class Real>
void Simulator<Real>::RecordedFrameAdjoint(State* state_bar, SystemGradient* gradient,
                                           Workspace* workspace) const {
  workspace->ClearGradients(nodes_);
  if (effects_) effects_->ClearGradient(&workspace->effects);
  // controllers and the spare node feel no force: their entries stay 0
  std::fill(workspace->force.begin(), workspace->force.end(), NodeForce<Real>{});
  for (int i = options_.substeps - 1; i >= 0; --i) SubstepAdjoint(i, state_bar, workspace);
  // the controllers' motion is given: what was added to them does not count
  std::fill(state_bar->begin() + nodes_, state_bar->begin() + springs_.spare_node + 1,
            NodeState<Real>{});
  if (!effects_) {
    AddGradients(*workspace, gradient);
    return;
  }
  SystemGradient frame(effects_->changed().system);
  AddGradients(*workspace, &frame);
  effects_->FinishGradient(workspace->input.delay_rate_start, workspace->input.delay_rate_end,
                           options_.frame_time, workspace->effects, &frame);
  *gradient += frame;
}

template <class Real>
void Simulator<Real>::Workspace::ClearGradients(int nodes) {
  spring_gradient.Clear();
  mass_gradient.assign(nodes, {});
  drag_gradient = gravity_gradient = {};
  contact_gradient = {std::vector<Real>(nodes, 0), {}};
}

template <class Real>
void Simulator<Real>::AddGradients(const Workspace& workspace, SystemGradient* gradient) const {
  const auto sum = [](const NodeForce<Real>& term) {
    return static_cast<double>(term.f[0] + term.f[1] + term.f[2]);
  };
  for (int i = 0; i < springs_.size(); ++i) {
    const int e = springs_.spring[i];
    if (e < 0) continue;
    gradient->stiffness[e] += static_cast<double>(workspace.spring_gradient.stiffness[i]);
    gradient->rest_length[e] += static_cast<double>(workspace.spring_gradient.rest_length[i]);
    gradient->dashpot[e] += static_cast<double>(workspace.spring_gradient.dashpot[i]);
  }
  const double h = options_.frame_time / options_.substeps;
  for (int i = 0; i < nodes_; ++i) {
    const double inverse_mass = static_cast<double>(h_over_mass_[i]) / h;
    gradient->mass[i] += static_cast<double>(workspace.contact_gradient.mass[i]) -
                         sum(workspace.mass_gradient[i]) * inverse_mass;
  }
  gradient->drag -= h * sum(workspace.drag_gradient);
  for (int j = 0; j < 3; ++j) {
    gradient->gravity[j] += h * static_cast<double>(workspace.gravity_gradient.f[j]);
  }
  const ContactLaws<Real>& laws = workspace.contact_gradient.laws;
  gradient->contact.surface.restitution += static_cast<double>(laws.surface.restitution);
  gradient->contact.surface.friction += static_cast<double>(laws.surface.friction);
  gradient->contact.object.restitution += static_cast<double>(laws.object.restitution);
  gradient->contact.object.friction += static_cast<double>(laws.object.friction);
}

template class Simulator<float>;
template class Simulator<double>;

}  // namespace physpring
