// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_model.h"

#include <algorithm>
#include <cmath>

#include "twin/effects/registry.h"

namespace physpring {

EffectModel::EffectModel(Parameters own, double scale, std::vector<EffectValues> start)
    : own_(std::move(own)), scale_(scale), start_(std::move(start)) {
  for (const EffectValues& effect : start_) {
    for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
      const bool logarithmic = parameter.spacing == EffectParameter::Spacing::kLogarithmic;
      entries_.insert(entries_.end(), static_cast<std::size_t>(parameter.count),
                      {parameter.low, parameter.high, parameter.scale, logarithmic});
    }
  }
  effect_size_ = static_cast<int>(entries_.size());
}

double EffectModel::Value(const Entry& entry, double start, double x) {
  const double value = entry.logarithmic ? start * std::exp(x) : start + entry.scale * x;
  return std::clamp(value, entry.low, entry.high);
}

SpringMassSystem EffectModel::Apply(const Eigen::VectorXd& x) const {
  SpringMassSystem system = own_.Apply(scale_ * x.head(own_.size()));
  system.effects = start_;
  std::size_t i = 0;
  for (EffectValues& effect : system.effects) {
    for (double& value : effect.values) {
      value = Value(entries_[i], value, x[own_.size() + static_cast<Eigen::Index>(i)]);
      ++i;
    }
  }
  return system;
}

Eigen::VectorXd EffectModel::Adjoint(const Eigen::VectorXd& x, const SpringMassSystem& system,
                                     const SystemGradient& gradient) const {
  Eigen::VectorXd bar(size());
  bar.head(own_.size()) = scale_ * own_.Adjoint(system, gradient);
  Eigen::Index i = own_.size();
  for (std::size_t n = 0; n < start_.size(); ++n) {
    for (Eigen::Index j = 0; j < start_[n].values.size(); ++j, ++i) {
      const Entry& entry = entries_[static_cast<std::size_t>(i - own_.size())];
      const double value = system.effects[n].values[j];
      // forward: value = start exp(x), or start + scale x; nothing passes where it is clamped
      const double slope = entry.logarithmic ? value : entry.scale;
      const double free = entry.logarithmic ? start_[n].values[j] * std::exp(x[i])
                                            : start_[n].values[j] + entry.scale * x[i];
      bar[i] = free < entry.low || free > entry.high ? 0 : gradient.effects[n][j] * slope;
    }
  }
  return bar;
}

}  // namespace physpring
