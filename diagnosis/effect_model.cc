// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_model.h"

#include <cmath>

namespace physpring {

EffectModel::EffectModel(Parameters own, OwnRange range, std::vector<EffectValues> start)
    : own_(std::move(own)), range_(range), effects_(std::move(start)) {}

Eigen::VectorXd EffectModel::OwnValues(const Eigen::VectorXd& x) const {
  Eigen::VectorXd values = range_.scale * x.head(own_.size());
  if (std::isfinite(range_.limit)) {
    values = range_.limit * (values / range_.limit).array().tanh();
  }
  return values;
}

SpringMassSystem EffectModel::Apply(const Eigen::VectorXd& x) const {
  SpringMassSystem system = own_.Apply(OwnValues(x));
  const std::vector<EffectValues> effects = effects_.Apply(x.tail(effects_.size()));
  system.effects.insert(system.effects.end(), effects.begin(), effects.end());
  return system;
}

Eigen::VectorXd EffectModel::Adjoint(const Eigen::VectorXd& x, const SpringMassSystem& system,
                                     const SystemGradient& gradient) const {
  Eigen::VectorXd bar(size());
  // forward: y = limit tanh(scale x / limit):  dy / dx = scale (1 - (y / limit)^2)
  const Eigen::VectorXd values = OwnValues(x);
  const Eigen::ArrayXd part = values.array() / range_.limit;
  bar.head(own_.size()) =
      range_.scale * (1 - part.square()) * own_.Adjoint(values, system, gradient).array();
  const auto own_effects = static_cast<std::ptrdiff_t>(own_.base().effects.size());
  bar.tail(effects_.size()) = effects_.Adjoint(
      x.tail(effects_.size()), {gradient.effects.begin() + own_effects, gradient.effects.end()});
  return bar;
}

}  // namespace physpring
