// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/tension_step.h"

#include <numeric>

#include "twin/effects/registry.h"

namespace physpring {

template <class Real>
TensionStep<Real>::TensionStep(const SpringMassSystem& system, int springs, int first_record)
    : springs_(springs), end_record_(first_record) {
  for (std::size_t i = 0; i < system.effects.size(); ++i) {
    const EffectValues& effect = system.effects[i];
    auto law = GetEffect(effect.name).MakeTension(effect.values);
    if (!law) continue;
    const int records = law->has_internal() ? springs / kRecordSize : 0;
    tensions_.push_back({i, effect.values.size(), std::move(law), end_record_});
    end_record_ += records;
  }
}

// Lengths and rates, with a force_bar tension_bar, too; no tension yet.
template <class Real>
SpringMoments<Real> TensionStep<Real>::Measure(const EffectSubstep<Real>& now,
                                               const NodeForce<Real>* force_bar,
                                               TensionBuffers<Real>* buffers) const {
  buffers->length.resize(springs_);
  buffers->rate.resize(springs_);
  buffers->tension_bar.resize(springs_);
  buffers->tension.assign(springs_, 0);
  now.kernel.measure_springs(
      now.springs, now.state.data(), force_bar,
      {buffers->length.data(), buffers->rate.data(), buffers->tension_bar.data()});
  return {springs_,
          buffers->length.data(),
          buffers->rate.data(),
          now.springs.stiffness,
          now.springs.rest_length,
          now.time,
          now.step};
}

template <class Real>
void TensionStep<Real>::AddForces(const EffectSubstep<Real>& now, State* next,
                                  NodeForces<Real>* force, TensionBuffers<Real>* buffers) const {
  SpringView<Real> springs = now.springs;
  if (!tensions_.empty()) {
    const SpringMoments<Real> moments = Measure(now, nullptr, buffers);
    for (const Tension& tension : tensions_) {
      tension.law->Add(moments, Internal(now.state, tension.record), Internal(next, tension.record),
                       buffers->tension.data());
    }
    springs.tension = buffers->tension.data();
  }
  now.kernel.add_spring_forces(springs, now.state.data(), force->data());
}

template <class Real>
void TensionStep<Real>::ClearGradient(TensionBuffers<Real>* buffers) const {
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
    const SpringMoments<Real> moments = Measure(now, force_bar.data(), buffers);
    buffers->length_bar.assign(springs_, 0);
    buffers->rate_bar.assign(springs_, 0);
    for (std::size_t i = 0; i < tensions_.size(); ++i) {
      const int record = tensions_[i].record;
      tensions_[i].law->AddAdjoint(
          moments, Internal(now.state, record),
          {buffers->tension_bar.data(), buffers->length_bar.data(), buffers->rate_bar.data(),
           gradient.stiffness, gradient.rest_length, Internal(state_bar, record),
           buffers->values_bar[i].data()},
          buffers->tension.data());
    }
    springs.tension = buffers->tension.data();
    gradient.length = buffers->length_bar.data();
    gradient.rate = buffers->rate_bar.data();
  }
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
