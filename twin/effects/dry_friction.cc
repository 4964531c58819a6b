// SPDX-License-Identifier: Apache-2.0
// Dry friction inside the springs, independent of the rate: beside each spring an element of the
// same stiffness k that slips at the stretch phi L (Prandtl's element):
//   z <- clamp(z + h dl/dt, -phi L, phi L),   extra tension k z
// At large motion the tension is +-phi k L: in MuJoCo a tendon's frictionloss.
#include <fmt/format.h>

#include <algorithm>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

class DryFrictionLaw {
 public:
  static constexpr bool kHasInternal = true;

  DryFrictionLaw(const Eigen::VectorXd& values, const Instant& instant)
      : slip_strain_(values[0]), step_(instant.step) {}

  double Tension(const SpringMoment& s, double* z) const {
    const double slip = slip_strain_ * s.rest_length;
    *z = std::clamp(*z + step_ * s.rate, -slip, slip);
    return s.stiffness * *z;
  }

  void TensionAdjoint(const SpringMoment& s, double z, double tension_bar, double* z_bar,
                      SpringMoment* bar, Eigen::VectorXd* values_bar) const {
    double after = z;
    Tension(s, &after);
    bar->stiffness += tension_bar * after;
    *z_bar += tension_bar * s.stiffness;
    const double free = z + step_ * s.rate;
    if (after == free) {
      bar->rate += step_ * *z_bar;
      return;
    }
    const double sign = free > after ? 1 : -1;
    (*values_bar)[0] += sign * s.rest_length * *z_bar;
    bar->rest_length += sign * slip_strain_ * *z_bar;
    *z_bar = 0;
  }

 private:
  double slip_strain_, step_;
};

class DryFriction : public Effect {
 public:
  std::string name() const override { return "dry_friction"; }
  std::vector<EffectParameter> parameters() const override {
    return {{"slip_strain", 0, 1, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Constant(1, 1e-3), Eigen::VectorXd::Constant(1, 0.02)};
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<SpringEffectForce<DryFrictionLaw>>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    if (!values.isZero()) bound->stiffness *= 2;
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    EffectMjcf mjcf{EffectMjcf::Carrier::kTendon,
                    {},
                    {},
                    "MuJoCo's friction loss slips at once; here a spring gives way first"};
    for (int e = 0; e < system.spring_count(); ++e) {
      const double force = values[0] * system.stiffness[e] * system.rest_length[e];
      mjcf.tendon.push_back({{"frictionloss", fmt::format("{}", force)}});
    }
    return mjcf;
  }
};

}  // namespace

std::unique_ptr<Effect> MakeDryFriction() { return std::make_unique<DryFriction>(); }

}  // namespace physpring
