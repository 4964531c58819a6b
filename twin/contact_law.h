// SPDX-License-Identifier: Apache-2.0
// The contact law: what an impact makes of a relative velocity. With unit normal n, restitution e
// and Coulomb friction mu,
//   u_n = (u . n) n,   u_t = u - u_n,   u' = -e u_n + a u_t,
//   a = max(0, 1 - mu (1 + e) |u_n| / |u_t|)
// (PhysTwin's rule; its shift of the position to the time of impact is left out, so that MuJoCo can
// follow). It changes velocities only, and is applied while bodies approach (u . n < -kApproach).
// Shared by the trainer's simulator and the MuJoCo plugin.
#ifndef PHYSPRING_TWIN_CONTACT_LAW_H_
#define PHYSPRING_TWIN_CONTACT_LAW_H_

#include <Eigen/Core>
#include <algorithm>

namespace physpring {

// Approach slower than this is no impact, m/s.
inline constexpr double kApproach = 1e-4;
// Sliding slower than this has no direction, m/s.
inline constexpr double kSliding = 1e-6;

// Restitution and friction of one kind of contact.
template <class Real>
struct ContactPair {
  Real restitution = 0;
  Real friction = 0;
};

// Relative velocity after the impact. Needs |n| = 1 and u . n < 0.
template <class Real>
Eigen::Matrix<Real, 3, 1> Impact(const Eigen::Matrix<Real, 3, 1>& u,
                                 const Eigen::Matrix<Real, 3, 1>& n, const ContactPair<Real>& law) {
  const Real normal = u.dot(n);
  const Eigen::Matrix<Real, 3, 1> tangential = u - normal * n;
  const Real sliding = std::max(tangential.norm(), Real(kSliding));
  const Real kept = std::max(Real(0), 1 + law.friction * (1 + law.restitution) * normal / sliding);
  return -law.restitution * normal * n + kept * tangential;
}

// Adjoint of Impact: given bar = d loss / d u', adds to the derivatives with respect to u, n and
// the coefficients.
template <class Real>
void ImpactAdjoint(const Eigen::Matrix<Real, 3, 1>& u, const Eigen::Matrix<Real, 3, 1>& n,
                   const ContactPair<Real>& law, const Eigen::Matrix<Real, 3, 1>& bar,
                   Eigen::Matrix<Real, 3, 1>* u_bar, Eigen::Matrix<Real, 3, 1>* n_bar,
                   ContactPair<Real>* law_bar) {
  using Vector = Eigen::Matrix<Real, 3, 1>;
  const Real normal = u.dot(n);
  const Vector tangential = u - normal * n;
  const Real norm = tangential.norm();
  const Real sliding = std::max(norm, Real(kSliding));
  const Real ratio = normal / sliding;  // <= 0
  const Real kept = std::max(Real(0), 1 + law.friction * (1 + law.restitution) * ratio);

  // forward: u' = -e normal n + kept tangential
  Real normal_bar = -law.restitution * bar.dot(n);
  Vector tangential_bar = kept * bar;
  *n_bar += -law.restitution * normal * bar;
  law_bar->restitution += -normal * bar.dot(n);
  if (kept > 0) {
    // forward: kept = 1 + mu (1 + e) normal / sliding
    const Real kept_bar = bar.dot(tangential);
    law_bar->friction += kept_bar * (1 + law.restitution) * ratio;
    law_bar->restitution += kept_bar * law.friction * ratio;
    const Real factor = law.friction * (1 + law.restitution) * kept_bar / sliding;
    normal_bar += factor;
    // forward: sliding = |tangential|
    if (norm > Real(kSliding)) tangential_bar -= factor * ratio / norm * tangential;
  }
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
