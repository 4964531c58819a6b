// SPDX-License-Identifier: Apache-2.0
// Dry friction inside the springs: beside each spring an element of the same stiffness k that slips
// at the stretch phi L (Prandtl's element) and, below that, may creep at the rate q:
//   z <- clamp((z + h dl/dt) exp(-q h), -phi L, phi L),   extra tension k z
// At large motion the tension is +-phi k L, whatever the rate: in MuJoCo a tendon's frictionloss,
// which creeps, too: below it the tendon is held by a dashpot (its solreffriction). Without creep
// (q = 0) all is independent of the rate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

template <class Real>
class DryFrictionLaw {
 public:
  static constexpr int kValues = 2;
  static constexpr bool kHasInternal = true;

  DryFrictionLaw(const Eigen::VectorXd& values, double /*time*/, double step)
      : slip_strain_(static_cast<Real>(values[0])),
        step_(static_cast<Real>(step)),
        loss_(static_cast<Real>(-std::expm1(-step * values[1]))) {}

  Real Tension(const SpringMoment<Real>& s, Real* z) const {
    const Real slip = slip_strain_ * s.rest_length;
    *z = std::min(std::max(Free(s, *z), -slip), slip);
    return s.stiffness * *z;
  }

  void TensionAdjoint(const SpringMoment<Real>& s, Real z, Real tension_bar, Real* z_bar,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    Real after = z;
    Tension(s, &after);
    bar->stiffness += tension_bar * after;
    *z_bar += tension_bar * s.stiffness;
    // forward: z' = (z + h rate) exp(-q h), or +-phi L if it slips
    const Real free = Free(s, z);
    const Real slip_bar = after == free ? 0 : *z_bar;
    const Real limit_bar = free > after ? slip_bar : -slip_bar;
    values_bar[0] += limit_bar * s.rest_length;
    bar->rest_length += limit_bar * slip_strain_;
    *z_bar -= slip_bar;
    values_bar[1] -= step_ * *z_bar * free;
    *z_bar -= loss_ * *z_bar;
    bar->rate += step_ * *z_bar;
  }

 private:
  Real Free(const SpringMoment<Real>& s, Real z) const {
    const Real held = z + step_ * s.rate;
    return held - loss_ * held;
  }

  Real slip_strain_, step_;
  Real loss_;  // 1 - exp(-q h), which has more digits in float
};

class DryFriction : public Effect {
 public:
  std::string name() const override { return "dry_friction"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "dry friction inside the material";
    picture.where = "in all springs";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    using Spacing = EffectParameter::Spacing;
    return {{"slip_strain", 0, 1, 1, 1, Spacing::kLogarithmic},
            {.key = "creep_per_s",
             .low = 0,
             .high = 1e4,  // at once
             .scale = 1,
             .spacing = Spacing::kLogarithmic,
             .bounds_are_natural = true}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::Vector2d(1e-3, 0), Eigen::Vector2d(0.02, 0), Eigen::Vector2d(0.01, 200)};
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    return std::make_unique<LawTension<DryFrictionLaw>>(values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    if (values[0] != 0) bound->stiffness *= 2;
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    EffectMjcf mjcf{
        EffectMjcf::Carrier::kTendon,
        {},
        {},
        "MuJoCo's friction loss has no spring that gives way first; it creeps in its own way"};
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
