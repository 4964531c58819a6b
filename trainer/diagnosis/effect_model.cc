// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_model.h"

#include <algorithm>
#include <cmath>

#include "twin/effects/registry.h"

namespace physpring {

EffectModel::EffectModel(Parameters own, OwnRange range, std::vector<EffectValues> start)
    : own_(std::move(own)), range_(range), start_(std::move(start)) {
  for (const EffectValues& effect : start_) {
    for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
      const bool logarithmic = parameter.spacing == EffectParameter::Spacing::kLogarithmic;
      entries_.insert(entries_.end(), static_cast<std::size_t>(parameter.count),
                      {parameter.low, parameter.high, parameter.scale, logarithmic});
    }
  }
  effect_size_ = static_cast<int>(entries_.size());
}

Eigen::VectorXd EffectModel::OwnValues(const Eigen::VectorXd& x) const {
  Eigen::VectorXd values = range_.scale * x.head(own_.size());
  if (std::isfinite(range_.limit)) {
    values = range_.limit * (values / range_.limit).array().tanh();
  }
  return values;
}

double EffectModel::Value(const Entry& entry, double start, double x) {
  const double value = entry.logarithmic ? start * std::exp(x) : start + entry.scale * x;
  return std::clamp(value, entry.low, entry.high);
}

SpringMassSystem EffectModel::Apply(const Eigen::VectorXd& x) const {
  SpringMassSystem system = own_.Apply(OwnValues(x));
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
  // forward: y = limit tanh(scale x / limit):  dy / dx = scale (1 - (y / limit)^2)
  const Eigen::ArrayXd part = OwnValues(x).array() / range_.limit;
  bar.head(own_.size()) =
      range_.scale * (1 - part.square()) * own_.Adjoint(system, gradient).array();
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
