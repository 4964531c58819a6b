// SPDX-License-Identifier: Apache-2.0
// What an effect along the springs is: an extra tension of each spring, from its length, the rate
// of it, time, and an internal variable. The kernel (twin/kernel.h) measures lengths and rates, and
// exerts the tension together with the spring's own. So arrays are in the kernel's order, fillings
// (of stiffness 0) included, and in the simulator's precision.
#ifndef PHYSPRING_TWIN_EFFECTS_SPRING_TENSION_H_
#define PHYSPRING_TWIN_EFFECTS_SPRING_TENSION_H_

namespace physpring {

// What the extra tension of a spring depends on, or the derivatives of a loss with respect to it.
template <class Real>
struct SpringMoment {
  Real length = 0;       // l, m
  Real rate = 0;         // how fast the length changes, m/s
  Real stiffness = 0;    // k of the spring, N/m
  Real rest_length = 0;  // L of the spring, m
  // Part of the rate that is a controller's own motion, m/s; also where dashpots take controllers
  // as standing still.
  Real pull = 0;
};

// The same of all springs in a sub-step, and the sub-step.
template <class Real>
struct SpringMoments {
  int count;
  const Real *length, *rate, *stiffness, *rest_length, *pull;  // (count)
  double time;                                                 // s since the start of the recording
  double step;                                                 // length of the sub-step, s

  SpringMoment<Real> operator[](int i) const {
    return {length[i], rate[i], stiffness[i], rest_length[i], pull[i]};
  }
};

// Derivatives of a loss.
template <class Real>
struct TensionGradient {
  const Real* tension;                                   // (count) given
  Real *length, *rate, *stiffness, *rest_length, *pull;  // (count) added to
  Real* internal;  // (count) in d loss / d variables after the sub-step, out before
  Real* values;    // (count x values) added to: of the effect, each spring's share
};

// The tension that one effect with given values adds.
class SpringTension {
 public:
  virtual ~SpringTension() = default;

  // Whether springs have an internal variable, z. If not, what stands for z below is not read.
  virtual bool has_internal() const = 0;
  // Whether the controllers' pull counts. If not, it may be given as 0, and nothing is added to its
  // derivative.
  virtual bool feels_pull() const { return false; }

  // Adds the extra tension [N] of each spring; it pulls the ends together. z: before the sub-step;
  // sets z_after.
  virtual void Add(const SpringMoments<float>& springs, const float* z, float* z_after,
                   float* tension) const = 0;
  virtual void Add(const SpringMoments<double>& springs, const double* z, double* z_after,
                   double* tension) const = 0;

  // Adjoint of Add; adds the tension, too.
  virtual void AddAdjoint(const SpringMoments<float>& springs, const float* z,
                          const TensionGradient<float>& bar, float* tension) const = 0;
  virtual void AddAdjoint(const SpringMoments<double>& springs, const double* z,
                          const TensionGradient<double>& bar, double* tension) const = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_SPRING_TENSION_H_
