// SPDX-License-Identifier: Apache-2.0
// Springs whose stiffness drifts in time: k (1 + a t), t since the start of the recording. Extra
// tension a t k (l - L). A stiffness never falls below a tenth of what it was.
#include <algorithm>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

constexpr double kLeast = -0.9;  // the least value that a t counts with

template <class Real>
class StiffnessDriftLaw {
 public:
  static constexpr int kValues = 1;
  static constexpr bool kHasInternal = false;

  StiffnessDriftLaw(const Eigen::VectorXd& values, double time, double /*step*/)
      : drift_(static_cast<Real>(std::max(kLeast, values[0] * time))),
        drift_slope_(values[0] * time > kLeast ? static_cast<Real>(time) : 0) {}

  Real Tension(const SpringMoment<Real>& s, Real*) const {
    return drift_ * s.stiffness * (s.length - s.rest_length);
  }
  void TensionAdjoint(const SpringMoment<Real>& s, Real, Real tension_bar, Real*,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    const Real stretch = s.length - s.rest_length;
    values_bar[0] += tension_bar * drift_slope_ * s.stiffness * stretch;
    bar->stiffness += tension_bar * drift_ * stretch;
    bar->length += tension_bar * drift_ * s.stiffness;
    bar->rest_length -= tension_bar * drift_ * s.stiffness;
  }

 private:
  Real drift_;        // a t
  Real drift_slope_;  // its derivative with respect to a, s
};

class StiffnessDrift : public Effect {
 public:
  std::string name() const override { return "stiffness_drift"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a stiffness that changes with time, at a rate";
    picture.amount = 0;
    picture.where = "in all springs";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"relative_rate_per_s", -2, 2, 0.1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(1)};
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    return std::make_unique<LawTension<StiffnessDriftLaw>>(values);
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
