// SPDX-License-Identifier: Apache-2.0
// Effects that act along the springs: a law gives the extra tension of a spring from its length,
// the rate of it, time, and an internal variable; geometry and adjoint are the same for all.
//
// A `Law` is made for each sub-step from the effect's values and the instant, and has
//   kHasInternal             whether springs have an internal variable z
//   Tension(s, &z)           the tension [N] that is added; advances z
//   TensionAdjoint(s, z, tension_bar, &z_bar, &bar, &values_bar)
//                            z before the sub-step; z_bar in d loss / d z after, out before;
//                            adds to the rest
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

// Some springs in a row at an instant: several at once keep the processor's pipelines full.
class SpringBatch {
 public:
  static constexpr int kMost = 16;

  SpringBatch() {
    for (Row& n : n_) n.setZero();
    for (Row& u : u_) u.setZero();
  }

  // Springs first to first + kMost - 1, as far as there are.
  void Measure(const SpringMassSystem& system, const Instant& instant, int first);

  int count() const { return count_; }
  SpringMoment operator[](int i) const { return {length_.coeff(i), rate_.coeff(i), k_[i], L_[i]}; }

  // Tension t pulls the ends together.
  void AddForces(const double* tension, Points* force) const;
  // d loss / d tension of each spring, given force_bar.
  void TensionBar(const Points& force_bar, double* tension_bar) const;
  // Adjoint of AddForces and Measure, given the tension and the derivatives of spring i.
  void AddAdjoint(int i, double tension, const SpringMoment& bar, const Points& force_bar,
                  InstantGradient* gradient) const;

 private:
  using Row = Eigen::Array<double, kMost, 1>;

  const std::array<int, 2>* ends_ = nullptr;  // a, b of each spring
  const double *k_ = nullptr, *L_ = nullptr;
  int first_ = 0, count_ = 0;
  // n: from a to b, of length 1, or 0 for a spring too short to have a direction; u = v_b - v_a
  Row n_[3], u_[3], length_, rate_;
};

template <class Law>
class SpringEffectForce : public EffectForce {
 public:
  SpringEffectForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : values_(values), system_(system) {}

  int internal_size() const override { return Law::kHasInternal ? system_.spring_count() : 0; }

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd> internal,
           Points* force) const override {
    const Law law(values_, instant);
    SpringBatch batch;
    double tension[SpringBatch::kMost], none = 0;
    for (int first = 0; first < system_.spring_count(); first += SpringBatch::kMost) {
      batch.Measure(system_, instant, first);
      for (int i = 0; i < batch.count(); ++i) {
        tension[i] = law.Tension(batch[i], Law::kHasInternal ? &internal[first + i] : &none);
      }
      batch.AddForces(tension, force);
    }
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>& internal,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                  InstantGradient* gradient) const override {
    const Law law(values_, instant);
    SpringBatch batch;
    double tension_bar[SpringBatch::kMost], none = 0;
    for (int first = 0; first < system_.spring_count(); first += SpringBatch::kMost) {
      batch.Measure(system_, instant, first);
      batch.TensionBar(force_bar, tension_bar);
      for (int i = 0; i < batch.count(); ++i) {
        const double z = Law::kHasInternal ? internal[first + i] : 0;
        double z_after = z;
        const double tension = law.Tension(batch[i], &z_after);
        SpringMoment bar;
        law.TensionAdjoint(batch[i], z, tension_bar[i],
                           Law::kHasInternal ? &internal_bar[first + i] : &none, &bar,
                           &gradient->values);
        batch.AddAdjoint(i, tension, bar, force_bar, gradient);
      }
    }
  }

 private:
  const Eigen::VectorXd values_;
  const SpringMassSystem& system_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_SPRING_EFFECT_H_
