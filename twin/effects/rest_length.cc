// SPDX-License-Identifier: Apache-2.0
// Strain that the body has in its declared stress-free positions: rest lengths L (1 + f(s)), with f
// piecewise linear along the body (body_coordinate.h), at the middle of each spring.
#include "twin/effects/body_coordinate.h"
#include "twin/effects/effect.h"

namespace physpring {
namespace {

constexpr int kLengthKnots = 5;

// Row e: the weights of the knots in the field at spring e.
Eigen::MatrixXd SpringKnots(const SpringMassSystem& system) {
  const Eigen::VectorXd along = BodyCoordinate(system);
  Eigen::VectorXd middle(system.spring_count());
  for (int e = 0; e < system.spring_count(); ++e) {
    middle[e] = (along[system.springs[e][0]] + along[system.springs[e][1]]) / 2;
  }
  return KnotWeights(middle, kLengthKnots);
}

class RestLength : public Effect {
 public:
  std::string name() const override { return "rest_length"; }
  std::vector<EffectParameter> parameters() const override {
    return {{"strain", -0.8, 4, 0.03, kLengthKnots}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(kLengthKnots)};
  }

  void Change(const Eigen::VectorXd& values, Setting* setting) const override {
    if (values.isZero()) return;
    Eigen::VectorXd& length = setting->system.rest_length;
    length += length.cwiseProduct(SpringKnots(setting->system) * values);
  }

  void ChangeAdjoint(const Eigen::VectorXd& values, const Setting& before, SystemGradient* gradient,
                     Eigen::VectorXd* values_bar) const override {
    const Eigen::MatrixXd knots = SpringKnots(before.system);
    *values_bar +=
        knots.transpose() * gradient->rest_length.cwiseProduct(before.system.rest_length);
    gradient->rest_length += gradient->rest_length.cwiseProduct(knots * values);
  }

  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kSetting, {}, {}, ""};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeRestLength() { return std::make_unique<RestLength>(); }

}  // namespace physpring
