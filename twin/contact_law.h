// SPDX-License-Identifier: Apache-2.0
// The contact law: what an impact makes of a relative velocity. With unit normal n, restitution e
// and friction mu,
//   u_n = (u . n) n,   u_t = u - u_n,   u' = -e u_n + Slide(u_t, mu (1 + e) |u_n|)
// (PhysTwin's rule with Coulomb's cone, see friction_cone.h; its shift of the position to the time
// of impact is left out, so that MuJoCo can follow). It changes velocities only, and is applied
// while bodies approach (u . n < -kApproach). Shared by the trainer's simulator and the MuJoCo
// plugin.
#ifndef PHYSPRING_TWIN_CONTACT_LAW_H_
#define PHYSPRING_TWIN_CONTACT_LAW_H_

#include <Eigen/Core>
#include <iterator>

#include "twin/friction_cone.h"

namespace physpring {

// Approach slower than this is no impact, m/s.
inline constexpr double kApproach = 1e-4;

// The coefficients of one kind of contact, or derivatives with respect to them. A new one is a
// member, its line in kContactCoefficients, and its part in Impact and its adjoint.
template <class Real>
struct ContactPair {
  Real restitution = 0;  // e
  Real friction = 0;     // mu
  FrictionCone cone = FrictionCone::kElliptic;

  bool operator==(const ContactPair&) const = default;
  // With numbers of another precision.
  template <class Other>
  ContactPair<Other> To() const;
  // Adds derivatives with respect to the coefficients.
  template <class Other>
  ContactPair& operator+=(const ContactPair<Other>& bar);
};

// A coefficient: its name against ground and geoms, and between particles, in twin files, MJCF and
// messages; its greatest value (the least is 0).
template <class Real>
struct ContactCoefficient {
  const char* name;
  const char* object_name;
  double most;
  Real ContactPair<Real>::*member;
};

// All of them. Twin files, checks, training, the exporter, the plugin and reports go through this
// list.
template <class Real>
inline constexpr ContactCoefficient<Real> kContactCoefficients[] = {
    {"restitution", "object_restitution", 1, &ContactPair<Real>::restitution},
    {"friction", "object_friction", 2, &ContactPair<Real>::friction},
};

inline constexpr int kContactCount = std::size(kContactCoefficients<double>);

template <class Real>
template <class Other>
ContactPair<Other> ContactPair<Real>::To() const {
  ContactPair<Other> other;
  for (int i = 0; i < kContactCount; ++i) {
    other.*kContactCoefficients<Other>[i].member =
        static_cast<Other>(this->*kContactCoefficients<Real>[i].member);
  }
  other.cone = cone;
  return other;
}

template <class Real>
template <class Other>
ContactPair<Real>& ContactPair<Real>::operator+=(const ContactPair<Other>& bar) {
  for (int i = 0; i < kContactCount; ++i) {
    this->*kContactCoefficients<Real>[i].member +=
        static_cast<Real>(bar.*kContactCoefficients<Other>[i].member);
  }
  return *this;
}

// Relative velocity after the impact. Needs |n| = 1 and u . n < 0.
template <class Real>
Eigen::Matrix<Real, 3, 1> Impact(const Eigen::Matrix<Real, 3, 1>& u,
                                 const Eigen::Matrix<Real, 3, 1>& n, const ContactPair<Real>& law) {
  const Real normal = OrderedDot(u, n);
  const Eigen::Matrix<Real, 3, 1> tangential = u - normal * n;
  const Real limit = -law.friction * (1 + law.restitution) * normal;
  return -law.restitution * normal * n + Slide(law.cone, tangential, n, limit);
}

// Adjoint of Impact: given bar = d loss / d u', adds to the derivatives with respect to u, n and
// the coefficients.
template <class Real>
void ImpactAdjoint(const Eigen::Matrix<Real, 3, 1>& u, const Eigen::Matrix<Real, 3, 1>& n,
                   const ContactPair<Real>& law, const Eigen::Matrix<Real, 3, 1>& bar,
                   Eigen::Matrix<Real, 3, 1>* u_bar, Eigen::Matrix<Real, 3, 1>* n_bar,
                   ContactPair<Real>* law_bar) {
  using Vector = Eigen::Matrix<Real, 3, 1>;
  const Real normal = OrderedDot(u, n);
  const Vector tangential = u - normal * n;
  const Real limit = -law.friction * (1 + law.restitution) * normal;

  // forward: u' = -e normal n + Slide(tangential, n, limit)
  Real normal_bar = -law.restitution * bar.dot(n);
  *n_bar += -law.restitution * normal * bar;
  law_bar->restitution += -normal * bar.dot(n);
  Vector tangential_bar = Vector::Zero();
  Real limit_bar = 0;
  SlideAdjoint(law.cone, tangential, n, limit, bar, &tangential_bar, n_bar, &limit_bar);
  // forward: limit = -mu (1 + e) normal
  law_bar->friction += -limit_bar * (1 + law.restitution) * normal;
  law_bar->restitution += -limit_bar * law.friction * normal;
  normal_bar -= limit_bar * law.friction * (1 + law.restitution);
  // forward: tangential = u - normal n
  *u_bar += tangential_bar;
  normal_bar -= tangential_bar.dot(n);
  *n_bar -= normal * tangential_bar;
  // forward: normal = u . n
  *u_bar += normal_bar * n;
  *n_bar += normal_bar * u;
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CONTACT_LAW_H_
