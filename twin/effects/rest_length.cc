// SPDX-License-Identifier: Apache-2.0
// Strain that the body has in its declared stress-free positions: rest lengths L (1 + f(s) + g y),
// at the middle of each spring. f is piecewise linear along the body, y is the place across it
// (body_coordinate.h). The gradient g bends a body without stress: with 1/m to a radius of 1 m.
#include "twin/effects/body_coordinate.h"
#include "twin/effects/effect.h"

namespace physpring {
namespace {

constexpr int kLengthKnots = 5;

// Row e: the weights of all values in the strain of spring e.
Eigen::MatrixXd SpringFields(const SpringMassSystem& system) {
  const Eigen::VectorXd along = BodyCoordinate(system);
  const Points across = PlaceAcross(system);
  Eigen::VectorXd middle(system.spring_count());
  Eigen::MatrixXd fields(system.spring_count(), kLengthKnots + 3);
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    middle[e] = (along[a] + along[b]) / 2;
    fields.row(e).tail<3>() = (across.col(a) + across.col(b)) / 2;
  }
  fields.leftCols(kLengthKnots) = KnotWeights(middle, kLengthKnots);
  return fields;
}

class RestLength : public Effect {
 public:
  std::string name() const override { return "rest_length"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a change of its length at rest";
    picture.profiles = {{"strain at rest", 0, kLengthKnots}};
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"strain", -0.8, 4, 0.03, kLengthKnots},
            {"strain_gradient_x_per_m", -100, 100, 1},
            {"strain_gradient_y_per_m", -100, 100, 1},
            {"strain_gradient_z_per_m", -100, 100, 1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(kLengthKnots + 3)};
  }

  void Change(const Eigen::VectorXd& values, Setting* setting) const override {
    if (values.isZero()) return;
    Eigen::VectorXd& length = setting->system.rest_length;
    length += length.cwiseProduct(SpringFields(setting->system) * values);
  }

  void ChangeAdjoint(const Eigen::VectorXd& values, const Setting& before, SystemGradient* gradient,
                     Eigen::VectorXd* values_bar) const override {
    const Eigen::MatrixXd fields = SpringFields(before.system);
    *values_bar +=
        fields.transpose() * gradient->rest_length.cwiseProduct(before.system.rest_length);
    gradient->rest_length += gradient->rest_length.cwiseProduct(fields * values);
  }

  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kSetting, {}, {}, ""};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeRestLength() { return std::make_unique<RestLength>(); }

}  // namespace physpring
