// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/spring_effect.h"

#include "twin/spring_law.h"

namespace physpring {

// n: from a to b, of length 1, or 0 for a spring too short to have a direction; u = v_b - v_a.
SpringMoment SpringEffectForce::Measure(const Instant& instant, int e, Eigen::Vector3d* n,
                                        Eigen::Vector3d* u) const {
  const auto [a, b] = system_.springs[e];
  *n = instant.x.col(b) - instant.x.col(a);
  *u = instant.v.col(b) - instant.v.col(a);
  const double length = n->norm();
  *n = length < kShortest ? Eigen::Vector3d::Zero() : Eigen::Vector3d(*n / length);
  return {length, n->dot(*u), system_.stiffness[e], system_.rest_length[e]};
}

void SpringEffectForce::Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd> internal,
                            Points* force) const {
  Eigen::Vector3d n, u;
  double none = 0;
  for (int e = 0; e < system_.spring_count(); ++e) {
    const SpringMoment spring = Measure(instant, e, &n, &u);
    const double tension = Tension(spring, instant, has_internal() ? &internal[e] : &none);
    force->col(system_.springs[e][0]) += tension * n;
    force->col(system_.springs[e][1]) -= tension * n;
  }
}

void SpringEffectForce::AddAdjoint(const Instant& instant,
                                   const Eigen::Ref<const Eigen::VectorXd>& internal,
                                   const Points& force_bar,
                                   Eigen::Ref<Eigen::VectorXd> internal_bar,
                                   InstantGradient* gradient) const {
  Eigen::Vector3d n, u;
  double none = 0;
  for (int e = 0; e < system_.spring_count(); ++e) {
    const auto [a, b] = system_.springs[e];
    const SpringMoment spring = Measure(instant, e, &n, &u);
    const double z = has_internal() ? internal[e] : 0;
    const Eigen::Vector3d w = force_bar.col(a) - force_bar.col(b);
    // forward: F_a += T n, F_b -= T n:  T_bar = n . w,  n_bar = T w
    double z_after = z;
    const double tension = Tension(spring, instant, &z_after);
    SpringMoment bar;
    TensionAdjoint(spring, instant, z, n.dot(w), has_internal() ? &internal_bar[e] : &none, &bar,
                   &gradient->values);
    gradient->parameters->stiffness[e] += bar.stiffness;
    gradient->parameters->rest_length[e] += bar.rest_length;
    if (n.isZero()) continue;
    // forward: rate = n . u, n = d / l, l = |d|
    const Eigen::Vector3d n_bar = tension * w + bar.rate * u;
    const Eigen::Vector3d d_bar = bar.length * n + (n_bar - n.dot(n_bar) * n) / spring.length;
    gradient->x.col(a) -= d_bar;
    gradient->x.col(b) += d_bar;
    gradient->v.col(a) -= bar.rate * n;
    gradient->v.col(b) += bar.rate * n;
  }
}

}  // namespace physpring
