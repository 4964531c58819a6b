// SPDX-License-Identifier: Apache-2.0
// Effects that act along the springs: a law gives the extra tension of a spring, and its adjoint;
// the loop over the springs is the same for all.
//
// A `Law<Real>` is made for each sub-step from the effect's values, the time and the sub-step
// (spring_tension.h), and has
//   kValues, kHasInternal    how many values; whether springs have an internal variable z
//   Tension(s, &z)           the tension [N] that is added; advances z
//   TensionAdjoint(s, z, tension_bar, &z_bar, &bar, values_bar)
//                            z before the sub-step; z_bar in d loss / d z after, out before;
//                            adds to the rest
// A law chooses by `?:`, min and max: then the compiler makes vector instructions of the loop. A
// spring without stiffness, a filling, has no tension and adds nothing to values_bar.
#ifndef PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_
#define PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_

#include "twin/effects/effect.h"

namespace physpring {

template <template <class> class Law>
class LawTension : public SpringTension {
 public:
  explicit LawTension(const Eigen::VectorXd& values) : values_(values) {}

  bool has_internal() const override { return Law<double>::kHasInternal; }
  bool feels_pull() const override { return kFeelsPull; }

  void Add(const SpringMoments<float>& springs, const float* z, float* z_after,
           float* tension) const override {
    AddLaw(springs, z, z_after, tension);
  }
  void Add(const SpringMoments<double>& springs, const double* z, double* z_after,
           double* tension) const override {
    AddLaw(springs, z, z_after, tension);
  }
  void AddAdjoint(const SpringMoments<float>& springs, const float* z,
                  const TensionGradient<float>& bar, float* tension) const override {
    AddLawAdjoint(springs, z, bar, tension);
  }
  void AddAdjoint(const SpringMoments<double>& springs, const double* z,
                  const TensionGradient<double>& bar, double* tension) const override {
    AddLawAdjoint(springs, z, bar, tension);
  }

 private:
  static constexpr bool kFeelsPull = requires { Law<double>::kFeelsPull; };

  template <class Real>
  void AddLaw(const SpringMoments<Real>& springs, const Real* z, Real* z_after,
              Real* tension) const {
    const Law<Real> law(values_, springs.time, springs.step);
#pragma GCC ivdep  // see below
    for (int i = 0; i < springs.count; ++i) {
      Real internal = Law<Real>::kHasInternal ? z[i] : 0;
      tension[i] += law.Tension(springs[i], &internal);
      if (Law<Real>::kHasInternal) z_after[i] = internal;
    }
  }

  template <class Real>
  void AddLawAdjoint(const SpringMoments<Real>& springs, const Real* z,
                     const TensionGradient<Real>& bar, Real* tension) const {
    const Law<Real> law(values_, springs.time, springs.step);
    // no array overlaps another: with so many, the compiler would not test it
#pragma GCC ivdep
    for (int i = 0; i < springs.count; ++i) {
      const Real before = Law<Real>::kHasInternal ? z[i] : 0;
      Real after = before, z_bar = Law<Real>::kHasInternal ? bar.internal[i] : 0;
      tension[i] += law.Tension(springs[i], &after);
      SpringMoment<Real> moment;
      Real values[Law<Real>::kValues] = {};
      law.TensionAdjoint(springs[i], before, bar.tension[i], &z_bar, &moment, values);
      bar.length[i] += moment.length;
      bar.rate[i] += moment.rate;
      bar.stiffness[i] += moment.stiffness;
      bar.rest_length[i] += moment.rest_length;
      if constexpr (kFeelsPull) bar.pull[i] += moment.pull;
      if (Law<Real>::kHasInternal) bar.internal[i] = z_bar;
      for (int n = 0; n < Law<Real>::kValues; ++n) {
        bar.values[n * springs.count + i] += values[n];
      }
    }
  }

  const Eigen::VectorXd values_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_
