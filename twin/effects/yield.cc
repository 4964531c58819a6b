// SPDX-License-Identifier: Apache-2.0
// Springs that yield: ideal plasticity, as MuJoCo's springyield. The rest length moves by p so that
// the elastic stretch l - L - p stays within +-y:
//   p <- clamp(p, l - L - y, l - L + y),   extra tension -k p
// The threshold is a length, the same for all springs (MuJoCo's), plus a strain times the rest
// length. If both are 0 nothing yields.
#include <fmt/format.h>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

class YieldLaw {
 public:
  static constexpr bool kHasInternal = true;

  YieldLaw(const Eigen::VectorXd& values, const Instant&)
      : stretch_(values[0]), strain_(values[1]) {}

  double Tension(const SpringMoment& s, double* p) const {
    if (stretch_ == 0 && strain_ == 0) return 0;
    const double stretch = s.length - s.rest_length;
    const double threshold = stretch_ + strain_ * s.rest_length;
    if (stretch - *p > threshold) {
      *p = stretch - threshold;
    } else if (stretch - *p < -threshold) {
      *p = stretch + threshold;
    }
    return -s.stiffness * *p;
  }

  void TensionAdjoint(const SpringMoment& s, double p, double tension_bar, double* p_bar,
                      SpringMoment* bar, Eigen::VectorXd* values_bar) const {
    if (stretch_ == 0 && strain_ == 0) return;
    double after = p;
    Tension(s, &after);
    // forward: T = -k p
    bar->stiffness -= tension_bar * after;
    *p_bar -= tension_bar * s.stiffness;
    if (after == p) return;
    // forward: p = l - L -+ (y_m + y L)
    const double sign = after > p ? -1 : 1;
    bar->length += *p_bar;
    bar->rest_length += (sign * strain_ - 1) * *p_bar;
    (*values_bar)[0] += sign * *p_bar;
    (*values_bar)[1] += sign * s.rest_length * *p_bar;
    *p_bar = 0;
  }

 private:
  double stretch_, strain_;  // where it yields
};

class Yield : public Effect {
 public:
  std::string name() const override { return "yield"; }
  std::vector<EffectParameter> parameters() const override {
    using Spacing = EffectParameter::Spacing;
    return {{"yield_stretch_m", 0, 1, 1, 1, Spacing::kLogarithmic},
            {"yield_strain", 0, 10, 1, 1, Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem& system) const override {
    std::vector<Eigen::VectorXd> starts;
    const double length = system.rest_length.mean();
    for (double strain : {0.01, 0.03, 0.1, 0.3}) {
      starts.emplace_back(Eigen::Vector2d(strain * length, 0));
      starts.emplace_back(Eigen::Vector2d(0, strain));
    }
    return starts;
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<SpringEffectForce<YieldLaw>>(system, values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    EffectMjcf mjcf{EffectMjcf::Carrier::kTendon, {}, {}, ""};
    for (int e = 0; e < system.spring_count(); ++e) {
      const double threshold = values[0] + values[1] * system.rest_length[e];
      mjcf.tendon.push_back({{"springyield", fmt::format("{}", threshold)}});
    }
    return mjcf;
  }
};

}  // namespace

std::unique_ptr<Effect> MakeYield() { return std::make_unique<Yield>(); }

}  // namespace physpring
