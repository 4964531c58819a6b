// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/effect_entries.h"

#include <algorithm>
#include <cmath>

#include "twin/effects/registry.h"

namespace physpring {

EffectEntries::EffectEntries(std::vector<EffectValues> start, double moment_unit)
    : start_(std::move(start)) {
  for (const EffectValues& effect : start_) {
    const double* value = effect.values.data();
    for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
      const bool logarithmic = parameter.spacing == EffectParameter::Spacing::kLogarithmic;
      const double scale = parameter.scale * (parameter.is_moment ? moment_unit : 1);
      for (int n = 0; n < parameter.count; ++n) {
        entries_.push_back(
            {*value++, parameter.low, parameter.high, scale, logarithmic, parameter.count > 1});
      }
    }
  }
}

double EffectEntries::Entry::Unbounded(double x) const {
  return logarithmic ? start * std::exp(x) : start + scale * x;
}

std::vector<EffectValues> EffectEntries::Apply(const Eigen::VectorXd& x) const {
  std::vector<EffectValues> effects = start_;
  Eigen::Index i = 0;
  for (EffectValues& effect : effects) {
    for (double& value : effect.values) {
      const Entry& entry = entries_[static_cast<std::size_t>(i)];
      value = std::clamp(entry.Unbounded(x[i]), entry.low, entry.high);
      ++i;
    }
  }
  return effects;
}

Eigen::VectorXd EffectEntries::Adjoint(const Eigen::VectorXd& x,
                                       const std::vector<Eigen::VectorXd>& gradient) const {
  Eigen::VectorXd bar(size());
  Eigen::Index i = 0;
  for (const Eigen::VectorXd& values_bar : gradient) {
    for (double value_bar : values_bar) {
      const Entry& entry = entries_[static_cast<std::size_t>(i)];
      const double value = entry.Unbounded(x[i]);
      const bool bound = value < entry.low || value > entry.high;
      bar[i++] = bound ? 0 : value_bar * (entry.logarithmic ? value : entry.scale);
    }
  }
  return bar;
}

}  // namespace physpring
