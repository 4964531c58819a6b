// SPDX-License-Identifier: Apache-2.0
// Springs that push less than they pull: a share s of the force of a compressed spring is taken
// away. s = 1 is a string that goes slack, in MuJoCo springlength="0 L".
#include <fmt/format.h>

#include <algorithm>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

template <class Real>
class TensionOnlyLaw {
 public:
  static constexpr int kValues = 1;
  static constexpr bool kHasInternal = false;

  TensionOnlyLaw(const Eigen::VectorXd& values, double /*time*/, double /*step*/)
      : slack_share_(static_cast<Real>(values[0])) {}

  Real Tension(const SpringMoment<Real>& s, Real*) const {
    return slack_share_ * s.stiffness * Slack(s);
  }
  void TensionAdjoint(const SpringMoment<Real>& s, Real, Real tension_bar, Real*,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    values_bar[0] += tension_bar * s.stiffness * Slack(s);
    bar->stiffness += tension_bar * slack_share_ * Slack(s);
    // forward: slack = L - l if that is positive
    const Real slack_bar = Slack(s) > 0 ? tension_bar * slack_share_ * s.stiffness : 0;
    bar->length -= slack_bar;
    bar->rest_length += slack_bar;
  }

 private:
  // How much shorter than at rest.
  static Real Slack(const SpringMoment<Real>& s) {
    return std::max(s.rest_length - s.length, Real(0));
  }

  Real slack_share_;
};

class TensionOnly : public Effect {
 public:
  std::string name() const override { return "tension_only"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "springs that go slack when they are pressed, with a share";
    picture.amount = 0;
    picture.where = "in all springs";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{.key = "slack_share", .low = 0, .high = 1, .scale = 0.3, .bounds_are_natural = true}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.8)};
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    return std::make_unique<LawTension<TensionOnlyLaw>>(values);
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
