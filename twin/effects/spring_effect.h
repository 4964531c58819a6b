// SPDX-License-Identifier: Apache-2.0
// Effects that act along the springs: a law gives the extra tension of a spring from its length,
// the rate of it, time, and an internal variable; geometry and adjoint are the same for all.
#ifndef PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_
#define PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_

#include "twin/effects/effect.h"

namespace physpring {

// What the extra tension of a spring depends on, or the derivatives of a loss with respect to it.
struct SpringMoment {
  double length = 0;       // l, m
  double rate = 0;         // of change of the length, m/s
  double stiffness = 0;    // k of the spring, N/m
  double rest_length = 0;  // L of the spring, m
};

class SpringEffectForce : public EffectForce {
 public:
  explicit SpringEffectForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : values_(values), system_(system) {}

  int internal_size() const override { return has_internal() ? system_.spring_count() : 0; }
  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd> internal,
           Points* force) const override;
  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>& internal,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                  InstantGradient* gradient) const override;

 protected:
  virtual bool has_internal() const { return false; }

  // The tension [N] that is added; advances the internal variable z.
  virtual double Tension(const SpringMoment& spring, const Instant& instant, double* z) const = 0;

  // Adjoint: z before the sub-step; *z_bar in d loss / d z after, out before. Adds to the rest.
  virtual void TensionAdjoint(const SpringMoment& spring, const Instant& instant, double z,
                              double tension_bar, double* z_bar, SpringMoment* bar,
                              Eigen::VectorXd* values_bar) const = 0;

  const Eigen::VectorXd values_;

 private:
  SpringMoment Measure(const Instant& instant, int e, Eigen::Vector3d* n, Eigen::Vector3d* u) const;

  const SpringMassSystem& system_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_
