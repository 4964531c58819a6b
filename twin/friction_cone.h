// SPDX-License-Identifier: Apache-2.0
// Dry friction: what an impact of strength `limit` (m/s: friction times the change of the normal
// velocity) leaves of a sliding velocity u_t, orthogonal to the unit normal n. Of all friction
// impulses within the cone, the one that takes most energy.
//   elliptic    Coulomb's: a u_t with a = max(0, 1 - limit / |u_t|)
//   pyramidal   as MuJoCo has it by default (`<option cone>`): with the components u_1 and u_2
//   along
//               two tangents, the impulses are those with |p_1| + |p_2| <= limit. The slower
//               component feels nothing until the faster one has become as slow:
//               u_i <- clamp(u_i, -c, c)
// The tangents are those of mju_makeFrame: the y axis of the world, made orthogonal to n (the z
// axis where |n_y| >= 0.5), and n x that.
#ifndef PHYSPRING_TWIN_FRICTION_CONE_H_
#define PHYSPRING_TWIN_FRICTION_CONE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace physpring {

enum class FrictionCone { kElliptic, kPyramidal };

// Sliding slower than this has no direction, m/s.
inline constexpr double kSliding = 1e-6;

// a . b, in the order of additions that rollouts side by side have too (Eigen's depends on the
// precision).
template <class Real>
Real OrderedDot(const Eigen::Matrix<Real, 3, 1>& a, const Eigen::Matrix<Real, 3, 1>& b) {
  return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}

// --- elliptic

template <class Real>
Eigen::Matrix<Real, 3, 1> SlideElliptic(const Eigen::Matrix<Real, 3, 1>& tangential, Real limit) {
  const Real norm = std::sqrt(OrderedDot(tangential, tangential));
  const Real sliding = std::max(norm, Real(kSliding));
  return std::max(Real(0), 1 - limit / sliding) * tangential;
}

// Adjoint: given bar = d loss / d result, adds to the derivatives with respect to the arguments.
template <class Real>
void SlideEllipticAdjoint(const Eigen::Matrix<Real, 3, 1>& tangential, Real limit,
                          const Eigen::Matrix<Real, 3, 1>& bar,
                          Eigen::Matrix<Real, 3, 1>* tangential_bar, Real* limit_bar) {
  const Real norm = std::sqrt(OrderedDot(tangential, tangential));
  const Real sliding = std::max(norm, Real(kSliding));
  const Real kept = std::max(Real(0), 1 - limit / sliding);
  // forward: kept tangential
  *tangential_bar += kept * bar;
  if (kept <= 0) return;
  // forward: kept = 1 - limit / sliding
  const Real kept_bar = bar.dot(tangential);
  *limit_bar -= kept_bar / sliding;
  // forward: sliding = |tangential|
  if (norm > Real(kSliding)) {
    *tangential_bar += kept_bar * limit / (sliding * sliding * norm) * tangential;
  }
}

// --- pyramidal

template <class Real>
struct Tangents {
  using Vector = Eigen::Matrix<Real, 3, 1>;

  explicit Tangents(const Vector& n)
      : axis(std::abs(n.y()) < Real(0.5) ? Vector::UnitY() : Vector::UnitZ()),
        projected(axis - axis.dot(n) * n),
        first(projected.normalized()),
        second(n.cross(first)) {}

  Vector axis, projected, first, second;
};

// The greatest speed c that is left along each tangent of the speeds a = |u_1| and b = |u_2|.
template <class Real>
Real PyramidSpeed(Real a, Real b, Real limit) {
  const Real faster = std::max(a, b), slower = std::min(a, b);
  if (limit <= faster - slower) return faster - limit;
  return std::max(Real(0), (a + b - limit) / 2);
}

template <class Real>
Eigen::Matrix<Real, 3, 1> SlidePyramidal(const Eigen::Matrix<Real, 3, 1>& tangential,
                                         const Eigen::Matrix<Real, 3, 1>& n, Real limit) {
  const Tangents<Real> t(n);
  const Real u1 = OrderedDot(tangential, t.first), u2 = OrderedDot(tangential, t.second);
  const Real c = PyramidSpeed(std::abs(u1), std::abs(u2), limit);
  return std::clamp(u1, -c, c) * t.first + std::clamp(u2, -c, c) * t.second;
}

template <class Real>
void SlidePyramidalAdjoint(const Eigen::Matrix<Real, 3, 1>& tangential,
                           const Eigen::Matrix<Real, 3, 1>& n, Real limit,
                           const Eigen::Matrix<Real, 3, 1>& bar,
                           Eigen::Matrix<Real, 3, 1>* tangential_bar,
                           Eigen::Matrix<Real, 3, 1>* n_bar, Real* limit_bar) {
  using Vector = Eigen::Matrix<Real, 3, 1>;
  const Tangents<Real> t(n);
  const Real u1 = OrderedDot(tangential, t.first), u2 = OrderedDot(tangential, t.second);
  const Real a = std::abs(u1), b = std::abs(u2);
  const Real c = PyramidSpeed(a, b, limit);

  // forward: w_1 t_1 + w_2 t_2, w_i = clamp(u_i, -c, c)
  const Real w1_bar = bar.dot(t.first), w2_bar = bar.dot(t.second);
  Vector first_bar = std::clamp(u1, -c, c) * bar, second_bar = std::clamp(u2, -c, c) * bar;
  const Real sign1 = u1 < 0 ? -1 : 1, sign2 = u2 < 0 ? -1 : 1;
  const Real c_bar = (a > c ? sign1 * w1_bar : 0) + (b > c ? sign2 * w2_bar : 0);
  Real u1_bar = a > c ? 0 : w1_bar, u2_bar = b > c ? 0 : w2_bar;
  // forward: c = PyramidSpeed(a, b, limit), a = |u_1|, b = |u_2|
  if (limit <= std::abs(a - b)) {
    (a > b ? u1_bar : u2_bar) += (a > b ? sign1 : sign2) * c_bar;
    *limit_bar -= c_bar;
  } else if (c > 0) {
    u1_bar += sign1 * c_bar / 2;
    u2_bar += sign2 * c_bar / 2;
    *limit_bar -= c_bar / 2;
  }
  // forward: u_i = tangential . t_i
  *tangential_bar += u1_bar * t.first + u2_bar * t.second;
  first_bar += u1_bar * tangential;
  second_bar += u2_bar * tangential;
  // forward: second = n x first, first = projected / |projected|, projected = axis - (axis . n) n
  *n_bar += t.first.cross(second_bar);
  first_bar += second_bar.cross(n);
  const Vector projected_bar = (first_bar - t.first.dot(first_bar) * t.first) / t.projected.norm();
  *n_bar -= projected_bar.dot(n) * t.axis + t.axis.dot(n) * projected_bar;
}

// --- either

template <class Real>
Eigen::Matrix<Real, 3, 1> Slide(FrictionCone cone, const Eigen::Matrix<Real, 3, 1>& tangential,
                                const Eigen::Matrix<Real, 3, 1>& n, Real limit) {
  return cone == FrictionCone::kElliptic ? SlideElliptic(tangential, limit)
                                         : SlidePyramidal(tangential, n, limit);
}

template <class Real>
void SlideAdjoint(FrictionCone cone, const Eigen::Matrix<Real, 3, 1>& tangential,
                  const Eigen::Matrix<Real, 3, 1>& n, Real limit,
                  const Eigen::Matrix<Real, 3, 1>& bar, Eigen::Matrix<Real, 3, 1>* tangential_bar,
                  Eigen::Matrix<Real, 3, 1>* n_bar, Real* limit_bar) {
  if (cone == FrictionCone::kElliptic) {
    SlideEllipticAdjoint(tangential, limit, bar, tangential_bar, limit_bar);
  } else {
    SlidePyramidalAdjoint(tangential, n, limit, bar, tangential_bar, n_bar, limit_bar);
  }
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_FRICTION_CONE_H_
