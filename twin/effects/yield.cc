// SPDX-License-Identifier: Apache-2.0
// Springs that yield: ideal plasticity, as MuJoCo's springyield. The rest length moves by p so that
// the elastic stretch l - L - p stays within +-y:
//   p <- clamp(p, l - L - y, l - L + y),   extra tension -k p
// The threshold is a length, the same for all springs (MuJoCo's), plus a strain times the rest
// length. If both are 0 nothing yields. Springs of controllers yield by where these were a lag
// before: l is less by lag times the pull (spring_tension.h). MuJoCo's springs of mocap bodies have
// a lag of its time step: it moves p to l + h J v with the velocities after the kick, those of
// mocap bodies counted as 0. A hand that is commanded rather than measured has one, too.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

template <class Real>
class YieldLaw {
 public:
  static constexpr int kValues = 3;
  static constexpr bool kHasInternal = true;
  static constexpr bool kFeelsPull = true;

  YieldLaw(const Eigen::VectorXd& values, double /*time*/, double /*step*/)
      : stretch_(values.head<2>().isZero(0) ? std::numeric_limits<Real>::infinity()
                                            : static_cast<Real>(values[0])),
        strain_(static_cast<Real>(values[1])),
        lag_(static_cast<Real>(values[2])) {}

  Real Tension(const SpringMoment<Real>& s, Real* p) const {
    const Real stretch = s.length - s.rest_length - lag_ * s.pull;
    const Real threshold = stretch_ + strain_ * s.rest_length;
    *p = std::min(std::max(*p, stretch - threshold), stretch + threshold);
    return -s.stiffness * *p;
  }

  void TensionAdjoint(const SpringMoment<Real>& s, Real p, Real tension_bar, Real* p_bar,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    Real after = p;
    Tension(s, &after);
    // forward: T = -k p
    bar->stiffness -= tension_bar * after;
    *p_bar -= tension_bar * s.stiffness;
    // forward: p = l - L - lag pull -+ (y_m + y L), if it yields
    const Real yield_bar = after == p ? 0 : *p_bar;
    const Real threshold_bar = after > p ? -yield_bar : yield_bar;
    bar->length += yield_bar;
    bar->rest_length += strain_ * threshold_bar - yield_bar;
    values_bar[0] += threshold_bar;
    values_bar[1] += threshold_bar * s.rest_length;
    bar->pull -= lag_ * yield_bar;
    values_bar[2] -= s.pull * yield_bar;
    *p_bar -= yield_bar;
  }

 private:
  Real stretch_, strain_;  // where it yields
  Real lag_;               // s
};

class Yield : public Effect {
 public:
  std::string name() const override { return "yield"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "springs that yield and stay bent";
    picture.where = "in all springs";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    using Spacing = EffectParameter::Spacing;
    return {{"yield_stretch_m", 0, 1, 1, 1, Spacing::kLogarithmic},
            {"yield_strain", 0, 10, 1, 1, Spacing::kLogarithmic},
            {.key = "controller_lag_s",
             .low = 0,
             .high = 0.02,
             .scale = 1e-4,
             .bounds_are_natural = true}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem& system) const override {
    std::vector<Eigen::VectorXd> starts;
    const double length = system.rest_length.mean();
    for (double strain : {0.01, 0.03, 0.1, 0.3}) {
      starts.emplace_back(Eigen::Vector3d(strain * length, 0, 0));
      starts.emplace_back(Eigen::Vector3d(0, strain, 0));
    }
    return starts;
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    return std::make_unique<LawTension<YieldLaw>>(values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    EffectMjcf mjcf{EffectMjcf::Carrier::kTendon,
                    {},
                    {},
                    "MuJoCo gives the springs of a mocap body a lag of its time step"};
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
