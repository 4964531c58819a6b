// SPDX-License-Identifier: Apache-2.0
// Springs with a memory, the standard linear solid in Prony's form: the share g of the stiffness k
// is a Maxwell branch, a spring in series with a dashpot, whose stretch z relaxes with the time
// tau:
//   z <- (z + h dl/dt) exp(-h / tau),   extra tension g k (z - (l - L))
// Fast motions meet the stiffness k, slow ones (1 - g) k; at the start all is relaxed.
#include <cmath>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

template <class Real>
class ViscoelasticLaw {
 public:
  static constexpr int kValues = 2;
  static constexpr bool kHasInternal = true;

  ViscoelasticLaw(const Eigen::VectorXd& values, double /*time*/, double step)
      : share_(static_cast<Real>(values[0])),
        step_(static_cast<Real>(step)),
        loss_(values[1] > 0 ? static_cast<Real>(-std::expm1(-step / values[1])) : 1),
        decay_slope_(values[1] > 0 ? static_cast<Real>(step / (values[1] * values[1])) : 0) {}

  Real Tension(const SpringMoment<Real>& s, Real* z) const {
    const Real free = *z + step_ * s.rate;
    *z = free - loss_ * free;
    return share_ * s.stiffness * (*z - (s.length - s.rest_length));
  }

  void TensionAdjoint(const SpringMoment<Real>& s, Real z, Real tension_bar, Real* z_bar,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    Real after = z;
    Tension(s, &after);
    const Real left = after - (s.length - s.rest_length);
    values_bar[0] += tension_bar * s.stiffness * left;
    bar->stiffness += tension_bar * share_ * left;
    const Real left_bar = tension_bar * share_ * s.stiffness;
    *z_bar += left_bar;
    bar->length -= left_bar;
    bar->rest_length += left_bar;
    // forward: z' = (z + h rate) exp(-h / tau)
    values_bar[1] += *z_bar * after * decay_slope_;
    *z_bar -= loss_ * *z_bar;
    bar->rate += step_ * *z_bar;
  }

 private:
  Real share_, step_;
  Real loss_;         // 1 - exp(-h / tau), which has more digits in float; 1 without a memory
  Real decay_slope_;  // h / tau^2: of exp(-h / tau) with tau, relative
};

class Viscoelastic : public Effect {
 public:
  std::string name() const override { return "viscoelastic"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a material that relaxes under load";
    picture.where = "in all springs";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {
        {.key = "relaxing_share", .low = 0, .high = 0.95, .scale = 0.3, .bounds_are_natural = true},
        {"relaxation_time_s", 0, 20, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::Vector2d(0.1, 0.03), Eigen::Vector2d(0.1, 0.2), Eigen::Vector2d(0.1, 1)};
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    return std::make_unique<LawTension<ViscoelasticLaw>>(values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "a tendon has no memory"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeViscoelastic() { return std::make_unique<Viscoelastic>(); }

}  // namespace physpring
