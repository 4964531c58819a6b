// SPDX-License-Identifier: Apache-2.0
// Springs with a memory: beside each spring a Maxwell branch, a spring of stiffness r k in series
// with a dashpot; its stretch z relaxes with the time tau:
//   z <- (z + h dl/dt) exp(-h / tau),   extra tension r k z
#include <cmath>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

class ViscoelasticLaw {
 public:
  static constexpr bool kHasInternal = true;

  ViscoelasticLaw(const Eigen::VectorXd& values, const Instant& instant)
      : ratio_(values[0]),
        time_(values[1]),
        step_(instant.step),
        decay_(time_ > 0 ? std::exp(-step_ / time_) : 0) {}

  double Tension(const SpringMoment& s, double* z) const {
    *z = (*z + step_ * s.rate) * decay_;
    return ratio_ * s.stiffness * *z;
  }

  void TensionAdjoint(const SpringMoment& s, double z, double tension_bar, double* z_bar,
                      SpringMoment* bar, Eigen::VectorXd* values_bar) const {
    double after = z;
    Tension(s, &after);
    (*values_bar)[0] += tension_bar * s.stiffness * after;
    bar->stiffness += tension_bar * ratio_ * after;
    *z_bar += tension_bar * ratio_ * s.stiffness;
    // forward: z' = (z + h rate) exp(-h / tau)
    if (time_ > 0) {
      (*values_bar)[1] += *z_bar * after * step_ / (time_ * time_);
    }
    *z_bar *= decay_;
    bar->rate += step_ * *z_bar;
  }

 private:
  double ratio_, time_, step_;
  double decay_;  // without a time there is no memory
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
    return std::make_unique<SpringEffectForce<ViscoelasticLaw>>(system, values);
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
