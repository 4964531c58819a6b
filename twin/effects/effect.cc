// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/effect.h"

#include <algorithm>

#include "twin/effects/bend_effect.h"

namespace physpring {

void Effect::Change(const Eigen::VectorXd&, Setting*) const {}

void Effect::ChangeAdjoint(const Eigen::VectorXd&, const Setting&, SystemGradient*,
                           Eigen::VectorXd*) const {}

std::unique_ptr<EffectForce> Effect::MakeForce(const SpringMassSystem&,
                                               const Eigen::VectorXd&) const {
  return nullptr;
}

std::unique_ptr<SpringTension> Effect::MakeTension(const Eigen::VectorXd&) const { return nullptr; }

std::unique_ptr<BendMoment> Effect::MakeBend(const SpringMassSystem&,
                                             const Eigen::VectorXd&) const {
  return nullptr;
}

bool Effect::HasForces(const SpringMassSystem& system, const Eigen::VectorXd& values) const {
  return MakeTension(values) != nullptr || MakeForce(system, values) != nullptr ||
         MakeBend(system, values) != nullptr;
}

Eigen::VectorXd Effect::StartOfRod(const RodTraits&) const { return {}; }

double Effect::FlexuralRigidity(const Eigen::VectorXd&) const { return 0; }

void Effect::Stiffen(const Eigen::VectorXd&, SpringMassSystem*) const {}

EffectPicture Effect::Picture(const Eigen::VectorXd&, const Setting&) const {
  EffectPicture picture;
  picture.lacks = name();
  std::replace(picture.lacks.begin(), picture.lacks.end(), '_', ' ');
  return picture;
}

bool IsAtBound(const EffectParameter& parameter, double value) {
  if (parameter.bounds_are_natural) return false;
  const double near = parameter.spacing == EffectParameter::Spacing::kLogarithmic
                          ? 0.02 * std::abs(value)
                          : 1e-3 * (parameter.high - parameter.low);
  return value > parameter.high - near || (parameter.low != 0 && value < parameter.low + near);
}

int Effect::value_count() const {
  int count = 0;
  for (const EffectParameter& parameter : parameters()) count += parameter.count;
  return count;
}

}  // namespace physpring
