// SPDX-License-Identifier: Apache-2.0
// Springs with a memory: beside each spring a Maxwell branch, a spring of stiffness r k in series
// with a dashpot; its stretch z relaxes with the time tau:
//   z <- (z + h dl/dt) exp(-h / tau),   extra tension r k z
#include <cmath>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

class ViscoelasticForce : public SpringEffectForce {
 public:
  using SpringEffectForce::SpringEffectForce;

 protected:
  bool has_internal() const override { return true; }

  double Tension(const SpringMoment& s, const Instant& instant, double* z) const override {
    *z = (*z + instant.step * s.rate) * Decay(instant);
    return values_[0] * s.stiffness * *z;
  }

  void TensionAdjoint(const SpringMoment& s, const Instant& instant, double z, double tension_bar,
                      double* z_bar, SpringMoment* bar,
                      Eigen::VectorXd* values_bar) const override {
    double after = z;
    Tension(s, instant, &after);
    (*values_bar)[0] += tension_bar * s.stiffness * after;
    bar->stiffness += tension_bar * values_[0] * after;
    *z_bar += tension_bar * values_[0] * s.stiffness;
    // forward: z' = (z + h rate) exp(-h / tau)
    if (values_[1] > 0) {
      (*values_bar)[1] += *z_bar * after * instant.step / (values_[1] * values_[1]);
    }
    *z_bar *= Decay(instant);
    bar->rate += instant.step * *z_bar;
  }

 private:
  // Without a time there is no memory.
  double Decay(const Instant& instant) const {
    return values_[1] > 0 ? std::exp(-instant.step / values_[1]) : 0;
  }
};

class Viscoelastic : public Effect {
 public:
  std::string name() const override { return "viscoelastic"; }
  std::vector<EffectParameter> parameters() const override {
    return {{"stiffness_ratio", 0, 20, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"relaxation_time_s", 0, 20, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::Vector2d(0.1, 0.03), Eigen::Vector2d(0.1, 0.2), Eigen::Vector2d(0.1, 1)};
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<ViscoelasticForce>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    bound->stiffness *= 1 + values[0];
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "a tendon has no memory"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeViscoelastic() { return std::make_unique<Viscoelastic>(); }

}  // namespace physpring
