// SPDX-License-Identifier: Apache-2.0
// Springs whose stiffness drifts in time: k (1 + a t), t since the start of the recording. Extra
// tension a t k (l - L). A stiffness never falls below a tenth of what it was.
#include <algorithm>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

constexpr double kLeast = -0.9;  // of a t

class StiffnessDriftLaw {
 public:
  static constexpr bool kHasInternal = false;

  StiffnessDriftLaw(const Eigen::VectorXd& values, const Instant& instant)
      : time_(instant.time), drift_(std::max(kLeast, values[0] * instant.time)) {}

  double Tension(const SpringMoment& s, double*) const {
    return drift_ * s.stiffness * (s.length - s.rest_length);
  }
  void TensionAdjoint(const SpringMoment& s, double, double tension_bar, double*, SpringMoment* bar,
                      Eigen::VectorXd* values_bar) const {
    const double stretch = s.length - s.rest_length;
    if (drift_ > kLeast) (*values_bar)[0] += tension_bar * time_ * s.stiffness * stretch;
    bar->stiffness += tension_bar * drift_ * stretch;
    bar->length += tension_bar * drift_ * s.stiffness;
    bar->rest_length -= tension_bar * drift_ * s.stiffness;
  }

 private:
  double time_;
  double drift_;  // a t
};

class StiffnessDrift : public Effect {
 public:
  std::string name() const override { return "stiffness_drift"; }
  std::vector<EffectParameter> parameters() const override {
    return {{"relative_rate_per_s", -2, 2, 0.1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(1)};
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<SpringEffectForce<StiffnessDriftLaw>>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    constexpr double kDuration = 10;  // s, of a long recording
    bound->stiffness *= 1 + std::max(0.0, values[0]) * kDuration;
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "a tendon's stiffness does not change in time"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeStiffnessDrift() { return std::make_unique<StiffnessDrift>(); }

}  // namespace physpring
