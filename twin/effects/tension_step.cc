// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/tension_step.h"

#include <algorithm>
#include <numeric>

#include "twin/effects/registry.h"
#include "twin/spring_law.h"

namespace physpring {
namespace {

// How fast the node and the controller of a spring come apart, and along which direction.
template <class Real>
struct Pull {
  Eigen::Vector3d velocity, direction;
  double length;

  Pull(const EffectSubstep<Real>& now, int controllers_begin, int controller, int node)
      : velocity(now.controller_velocity.col(controller)) {
    const NodeState<Real>& held = now.state[controllers_begin + controller];
    for (int j = 0; j < 3; ++j) {
      direction[j] = static_cast<double>(held.x[j]) - static_cast<double>(now.state[node].x[j]);
    }
    length = direction.norm();
    direction = length < kShortest ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(direction / length);
  }
  double Along() const { return velocity.dot(direction); }
};

}  // namespace

template <class Real>
TensionStep<Real>::TensionStep(const SpringMassSystem& system, const SpringView<Real>& springs,
                               int first_record)
    : nodes_(system.node_count()),
      controllers_(system.controllers),
      springs_(kSpringBlock * springs.blocks),
      end_record_(first_record) {
  bool feels_pull = false;
  for (std::size_t i = 0; i < system.effects.size(); ++i) {
    const EffectValues& effect = system.effects[i];
    auto law = GetEffect(effect.name).MakeTension(effect.values);
    if (!law) continue;
    feels_pull |= law->feels_pull();
    const int records = law->has_internal() ? springs_ / kRecordSize : 0;
    tensions_.push_back({i, effect.values.size(), std::move(law), end_record_});
    end_record_ += records;
  }
  for (int i = 0; feels_pull && i < springs_; ++i) {
    const auto [node, other] = std::minmax({springs.a[i / kSpringBlock], springs.b[i]});
    const int controller = other - nodes_;
    if (controller < 0 || controller >= controllers_ || node >= nodes_) continue;
    pulled_.push_back({i, controller, node});
  }
}

template <class Real>
void TensionStep<Real>::MeasurePull(const EffectSubstep<Real>& now,
                                    TensionBuffers<Real>* buffers) const {
  for (const auto& [spring, controller, node] : pulled_) {
    buffers->pull[spring] = static_cast<Real>(Pull<Real>(now, nodes_, controller, node).Along());
  }
}

template <class Real>
void TensionStep<Real>::MeasurePullAdjoint(const EffectSubstep<Real>& now, State* state_bar,
                                           TensionBuffers<Real>* buffers) const {
  for (const auto& [spring, controller, node] : pulled_) {
    const Pull<Real> pull(now, nodes_, controller, node);
    const double bar = static_cast<double>(buffers->pull_bar[spring]);
    if (bar == 0 || pull.length < kShortest) continue;
    // forward: pull = v . d / |d|, d = x_controller - x_node
    buffers->controller_velocity_bar.col(controller) += bar * pull.direction;
    const Eigen::Vector3d d_bar =
        bar / pull.length * (pull.velocity - pull.Along() * pull.direction);
    for (int j = 0; j < 3; ++j) {
      (*state_bar)[nodes_ + controller].x[j] += static_cast<Real>(d_bar[j]);
      (*state_bar)[node].x[j] -= static_cast<Real>(d_bar[j]);
    }
  }
}

template <class Real>
SpringMeasures<Real> TensionStep<Real>::Measures(TensionBuffers<Real>* buffers) const {
  buffers->length.resize(springs_);
  buffers->rate.resize(springs_);
  buffers->tension_bar.resize(springs_);
  return {buffers->length.data(), buffers->rate.data(), buffers->tension_bar.data()};
}

// What was measured, and pulls; no tension yet.
template <class Real>
SpringMoments<Real> TensionStep<Real>::Moments(const EffectSubstep<Real>& now,
                                               TensionBuffers<Real>* buffers) const {
  buffers->tension.assign(springs_, 0);
  buffers->pull.resize(springs_);
  MeasurePull(now, buffers);
  return {springs_,
          buffers->length.data(),
          buffers->rate.data(),
          now.springs.stiffness,
          now.springs.rest_length,
          buffers->pull.data(),
          now.time,
          now.step};
}

template <class Real>
const Real* TensionStep<Real>::AddTensions(const EffectSubstep<Real>& now, State* next,
                                           TensionBuffers<Real>* buffers) const {
  const SpringMoments<Real> moments = Moments(now, buffers);
  for (const Tension& tension : tensions_) {
    tension.law->Add(moments, Internal(now.state, tension.record), Internal(next, tension.record),
                     buffers->tension.data());
  }
  return buffers->tension.data();
}

template <class Real>
void TensionStep<Real>::AddForces(const EffectSubstep<Real>& now, State* next,
                                  NodeForces<Real>* force, TensionBuffers<Real>* buffers) const {
  SpringView<Real> springs = now.springs;
  if (along()) {
    now.kernel.measure_springs(springs, now.state.data(), nullptr, Measures(buffers));
    springs.tension = AddTensions(now, next, buffers);
  }
  now.kernel.add_spring_forces(springs, now.state.data(), force->data());
}

template <class Real>
void TensionStep<Real>::ClearGradient(TensionBuffers<Real>* buffers) const {
  buffers->controller_velocity_bar.setZero(3, controllers_);
  buffers->values_bar.resize(tensions_.size());
  for (std::size_t i = 0; i < tensions_.size(); ++i) {
    buffers->values_bar[i].assign(tensions_[i].values * springs_, 0);
  }
}

template <class Real>
void TensionStep<Real>::AddForcesAdjoint(const EffectSubstep<Real>& now,
                                         const NodeForces<Real>& force_bar, State* state_bar,
                                         SpringGradientView<Real> gradient,
                                         TensionBuffers<Real>* buffers) const {
  SpringView<Real> springs = now.springs;
  if (!tensions_.empty()) {
    now.kernel.measure_springs(springs, now.state.data(), force_bar.data(), Measures(buffers));
    const SpringMoments<Real> moments = Moments(now, buffers);
    buffers->length_bar.assign(springs_, 0);
    buffers->rate_bar.assign(springs_, 0);
    buffers->pull_bar.assign(springs_, 0);
    for (std::size_t i = 0; i < tensions_.size(); ++i) {
      const int record = tensions_[i].record;
      tensions_[i].law->AddAdjoint(
          moments, Internal(now.state, record),
          {buffers->tension_bar.data(), buffers->length_bar.data(), buffers->rate_bar.data(),
           gradient.stiffness, gradient.rest_length, buffers->pull_bar.data(),
           Internal(state_bar, record), buffers->values_bar[i].data()},
          buffers->tension.data());
    }
    springs.tension = buffers->tension.data();
    gradient.length = buffers->length_bar.data();
    gradient.rate = buffers->rate_bar.data();
  }
  MeasurePullAdjoint(now, state_bar, buffers);
  now.kernel.add_spring_forces_adjoint(springs, now.state.data(), force_bar.data(),
                                       state_bar->data(), gradient);
}

template <class Real>
void TensionStep<Real>::AddGradient(const TensionBuffers<Real>& buffers,
                                    SystemGradient* gradient) const {
  for (std::size_t i = 0; i < tensions_.size(); ++i) {
    auto share = buffers.values_bar[i].begin();
    for (double& value : gradient->effects[tensions_[i].effect]) {
      value = std::accumulate(share, share + springs_, value);
      share += springs_;
    }
  }
}

template class TensionStep<float>;
template class TensionStep<double>;

}  // namespace physpring
