// SPDX-License-Identifier: Apache-2.0
// Springs that stiffen with strain: the extra tension is alpha k (l - L)^3 / L^2, in MuJoCo the
// third coefficient of a tendon's stiffness.
#include <fmt/format.h>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

template <class Real>
class StiffeningLaw {
 public:
  static constexpr int kValues = 1;
  static constexpr bool kHasInternal = false;

  StiffeningLaw(const Eigen::VectorXd& values, double /*time*/, double /*step*/)
      : ratio_(static_cast<Real>(values[0])) {}

  Real Tension(const SpringMoment<Real>& s, Real*) const {
    const Real strain = (s.length - s.rest_length) / s.rest_length;
    return ratio_ * s.stiffness * s.rest_length * strain * strain * strain;
  }
  void TensionAdjoint(const SpringMoment<Real>& s, Real, Real tension_bar, Real*,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    const Real strain = (s.length - s.rest_length) / s.rest_length;
    const Real cube = strain * strain * strain;
    values_bar[0] += tension_bar * s.stiffness * s.rest_length * cube;
    bar->stiffness += tension_bar * ratio_ * s.rest_length * cube;
    // forward: strain = l / L - 1
    const Real slope = tension_bar * ratio_ * s.stiffness * 3 * strain * strain;
    bar->length += slope;
    bar->rest_length +=
        tension_bar * ratio_ * s.stiffness * cube - slope * s.length / s.rest_length;
  }

 private:
  Real ratio_;  // alpha
};

class Stiffening : public Effect {
 public:
  std::string name() const override { return "stiffening"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "springs that stiffen as they are stretched";
    picture.where = "in all springs";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"cubic_stiffness_ratio", 0, 1e4, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Constant(1, 1), Eigen::VectorXd::Constant(1, 10)};
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    return std::make_unique<LawTension<StiffeningLaw>>(values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    // at the strains that a soft body lives in
    constexpr double kStrain = 0.3;
    bound->stiffness *= 1 + 3 * values[0] * kStrain * kStrain;
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    EffectMjcf mjcf{EffectMjcf::Carrier::kTendon, {}, {}, ""};
    for (int e = 0; e < system.spring_count(); ++e) {
      const double length = system.rest_length[e];
      mjcf.tendon.push_back(
          {{"stiffness", fmt::format("{} 0 {}", system.stiffness[e],
                                     values[0] * system.stiffness[e] / (length * length))}});
    }
    return mjcf;
  }
};

}  // namespace

std::unique_ptr<Effect> MakeStiffening() { return std::make_unique<Stiffening>(); }

}  // namespace physpring
