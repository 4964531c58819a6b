// SPDX-License-Identifier: Apache-2.0
#include "twin/level_step.h"

#include <cmath>

namespace physpring {

template <class Real>
void NodeStep<Real>::Set(const SpringMassSystem& system, double h, const Eigen::Vector3d& gravity) {
  h_ = static_cast<Real>(h);
  for (int j = 0; j < 3; ++j) kick_.f[j] = h_ * static_cast<Real>(gravity[j]);
  decay_ = static_cast<Real>(std::exp(-h * system.drag));
  h_over_mass_.resize(system.node_count());
  for (int i = 0; i < system.node_count(); ++i) {
    h_over_mass_[i] = h_ * static_cast<Real>(1 / system.mass[i]);
  }
}

template <class Real>
LevelStep<Real>::LevelStep(const SpringMassSystem& system, const Environment& environment,
                           const Kernel<Real>& kernel)
    : kernel_(&kernel),
      springs_(system),
      dashpot_stages_(system.dashpot_stages),
      contact_(system, environment),
      gravity_(environment.gravity) {
  SetParameters(system);
}

template <class Real>
void LevelStep<Real>::SetParameters(const SpringMassSystem& system) {
  effects_ = std::make_shared<const EffectStep<Real>>(system, gravity_, springs_.View());
  springs_.SetParameters(effects_->changed().system);
  contact_.SetParameters(effects_->changed().system);
}

template <class Real>
void LevelStep<Real>::AddForces(const LevelSubstep<Real>& now, const State& state, State* next,
                                LevelBuffers<Real>* buffers) const {
  std::fill(buffers->force.begin(), buffers->force.end(), NodeForce<Real>{});
  EffectSubstep<Real> substep = EffectsOf(now, state);
  if (dashpot_stages_.count() > 1) {
    buffers->dashpots.direction.resize(3 * static_cast<std::size_t>(springs_.size()));
    substep.springs.direction = buffers->dashpots.direction.data();
  }
  effects_->AddForces(substep, next, &buffers->force, &buffers->effects);
  dashpot_stages_.Apply(*kernel_, substep.springs, now.nodes, &buffers->force, &buffers->dashpots);
}

template <class Real>
void LevelStep<Real>::ClearGradient(LevelBuffers<Real>* buffers) const {
  buffers->spring_gradient.Clear();
  buffers->mass_gradient.assign(effects_->changed().system.node_count(), {});
  buffers->drag_gradient = buffers->gravity_gradient = {};
  buffers->contact_gradient = {std::vector<Real>(buffers->mass_gradient.size(), 0), {}};
  effects_->ClearGradient(&buffers->effects);
  // controllers and the spare node feel no force: their entries stay 0
  std::fill(buffers->force.begin(), buffers->force.end(), NodeForce<Real>{});
}

template <class Real>
void LevelStep<Real>::AdvanceAdjoint(const LevelSubstep<Real>& now, const State& state, State* next,
                                     Impacts* impacts, State* state_bar,
                                     LevelBuffers<Real>* buffers) const {
  kernel_->update_positions_adjoint(now.nodes, state_bar->data());
  contact_.ApplyAdjoint(state, impacts, state_bar, &buffers->contact_gradient);
  contact_.Undo(*impacts, next);
  const NodeGradientView<Real> gradient{buffers->mass_gradient.data(), &buffers->drag_gradient,
                                        &buffers->gravity_gradient};
  if (dashpot_stages_.count() > 1) RepeatForces(now, state, buffers);
  kernel_->update_velocities_adjoint(now.nodes, state.data(), next->data(), state_bar->data(),
                                     buffers->force.data(), gradient);
  dashpot_stages_.ApplyAdjoint(*kernel_, springs_.Dashpots(), now.nodes, state, &buffers->force,
                               state_bar, buffers->spring_gradient.dashpot.data(), gradient,
                               &buffers->dashpots);
  effects_->AddForcesAdjoint(EffectsOf(now, state), buffers->force, state_bar,
                             buffers->spring_gradient.View(), &buffers->effects);
}

// What dashpots in stages keep for their adjoint.
template <class Real>
void LevelStep<Real>::RepeatForces(const LevelSubstep<Real>& now, const State& state,
                                   LevelBuffers<Real>* buffers) const {
  buffers->dashpots.next_state.resize(state.size());
  AddForces(now, state, &buffers->dashpots.next_state, buffers);
  // controllers and the spare node feel no force: their entries stay 0
  std::fill(buffers->force.begin(), buffers->force.end(), NodeForce<Real>{});
}

template <class Real>
void LevelStep<Real>::AddGradients(const NodeView<Real>& nodes, double h,
                                   const LevelBuffers<Real>& buffers,
                                   SystemGradient* gradient) const {
  const auto sum = [](const NodeForce<Real>& term) {
    return static_cast<double>(term.f[0] + term.f[1] + term.f[2]);
  };
  for (int i = 0; i < springs_.size(); ++i) {
    const int e = springs_.spring[i];
    if (e < 0) continue;
    gradient->stiffness[e] += static_cast<double>(buffers.spring_gradient.stiffness[i]);
    gradient->rest_length[e] += static_cast<double>(buffers.spring_gradient.rest_length[i]);
    gradient->dashpot[e] += static_cast<double>(buffers.spring_gradient.dashpot[i]);
  }
  for (int i = 0; i < nodes.nodes; ++i) {
    const double inverse_mass = static_cast<double>(nodes.h_over_mass[i]) / h;
    gradient->mass[i] += static_cast<double>(buffers.contact_gradient.mass[i]) -
                         sum(buffers.mass_gradient[i]) * inverse_mass;
  }
  gradient->drag -= h * sum(buffers.drag_gradient);
  for (int j = 0; j < 3; ++j) {
    gradient->gravity[j] += h * static_cast<double>(buffers.gravity_gradient.f[j]);
  }
  gradient->contact += buffers.contact_gradient.laws;
}

template class NodeStep<float>;
template class NodeStep<double>;
template class LevelStep<float>;
template class LevelStep<double>;

}  // namespace physpring
