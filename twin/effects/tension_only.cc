// SPDX-License-Identifier: Apache-2.0
// Springs that push less than they pull: a share s of the force of a compressed spring is taken
// away. s = 1 is a string that goes slack, in MuJoCo springlength="0 L".
#include <fmt/format.h>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

class TensionOnlyLaw {
 public:
  static constexpr bool kHasInternal = false;

  TensionOnlyLaw(const Eigen::VectorXd& values, const Instant&) : slack_share_(values[0]) {}

  double Tension(const SpringMoment& s, double*) const {
    if (s.length >= s.rest_length) return 0;
    return -slack_share_ * s.stiffness * (s.length - s.rest_length);
  }
  void TensionAdjoint(const SpringMoment& s, double, double tension_bar, double*, SpringMoment* bar,
                      Eigen::VectorXd* values_bar) const {
    if (s.length >= s.rest_length) return;
    const double stretch = s.length - s.rest_length;
    (*values_bar)[0] -= tension_bar * s.stiffness * stretch;
    bar->stiffness -= tension_bar * slack_share_ * stretch;
    bar->length -= tension_bar * slack_share_ * s.stiffness;
    bar->rest_length += tension_bar * slack_share_ * s.stiffness;
  }

 private:
  double slack_share_;
};

class TensionOnly : public Effect {
 public:
  std::string name() const override { return "tension_only"; }
  std::vector<EffectParameter> parameters() const override { return {{"slack_share", 0, 1, 0.3}}; }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.8)};
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<SpringEffectForce<TensionOnlyLaw>>(system, values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    if (values[0] < 1) {
      return {EffectMjcf::Carrier::kPlugin, {}, {}, "a tendon goes slack altogether or not at all"};
    }
    EffectMjcf mjcf{EffectMjcf::Carrier::kTendon, {}, {}, ""};
    for (int e = 0; e < system.spring_count(); ++e) {
      mjcf.tendon.push_back({{"springlength", fmt::format("0 {}", system.rest_length[e])}});
    }
    return mjcf;
  }
};

}  // namespace

std::unique_ptr<Effect> MakeTensionOnly() { return std::make_unique<TensionOnly>(); }

}  // namespace physpring
