// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_model.h"

#include <cmath>

namespace physpring {

EffectModel::EffectModel(Parameters own, OwnRange range, std::vector<EffectValues> start)
    : own_(std::move(own)), range_(range), effects_(std::move(start)) {}

EffectModel::EffectModel(std::shared_ptr<const SmoothBody> body, std::vector<EffectValues> start)
    : own_(body->factors()), smooth_(std::move(body)), effects_(std::move(start)) {}

Eigen::VectorXd EffectModel::OwnValues(const Eigen::VectorXd& x) const {
  Eigen::VectorXd values = range_.scale * x.head(own_.size());
  if (std::isfinite(range_.limit)) {
    values = range_.limit * (values / range_.limit).array().tanh();
  }
  return values;
}

SpringMassSystem EffectModel::Apply(const Eigen::VectorXd& x) const {
  SpringMassSystem system =
      smooth_ ? smooth_->Apply(x.head(own_.size())) : own_.Apply(OwnValues(x));
  const std::vector<EffectValues> effects = effects_.Apply(x.tail(effects_.size()));
  system.effects.insert(system.effects.end(), effects.begin(), effects.end());
  return system;
}

Eigen::MatrixXd EffectModel::Precision(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd precision = kDiagnosisPrecision * Eigen::MatrixXd::Identity(size(), size());
  const int own = own_.size();
  if (smooth_) precision.topLeftCorner(own, own) = smooth_->Precision(x.head(own));
  return precision;
}

}  // namespace physpring
