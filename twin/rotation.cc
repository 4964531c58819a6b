// SPDX-License-Identifier: Apache-2.0
#include "twin/rotation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <optional>

namespace physpring {
namespace {

// Newton's iteration with Frobenius scaling (Higham, Functions of Matrices, 2008, section 8.6):
// X <- (g X + X^-T / g) / 2 from A, where det A is well above 0. None where it is not, or the
// iteration does not end. A few times as fast as a decomposition.
std::optional<Eigen::Matrix3d> PolarRotationByNewton(const Eigen::Matrix3d& a) {
  constexpr int kMostSteps = 20;
  constexpr double kSingular = 1e-6, kConverged = 1e-15;
  Eigen::Matrix3d x = a;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Matrix3d cofactors;  // det X X^-T
    cofactors << x.col(1).cross(x.col(2)), x.col(2).cross(x.col(0)), x.col(0).cross(x.col(1));
    const double determinant = x.col(0).dot(cofactors.col(0));
    const double size = x.norm();
    if (!(determinant > kSingular * size * size * size)) return std::nullopt;
    const Eigen::Matrix3d inverse = cofactors / determinant;
    const double scale = std::sqrt(inverse.norm() / size);
    const Eigen::Matrix3d next = 0.5 * (scale * x + inverse / scale);
    const bool converged = (next - x).squaredNorm() < kConverged;  // and squared by this step
    x = next;
    if (converged) return x;
  }
  return std::nullopt;
}

// R in A = R S, det R = 1.
Eigen::Matrix3d PolarRotation(const Eigen::Matrix3d& a) {
  if (const auto rotation = PolarRotationByNewton(a)) return *rotation;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

// The vector w of the matrix W - W^T = [w]x.
Eigen::Vector3d SkewVector(const Eigen::Matrix3d& w) {
  return {w(2, 1) - w(1, 2), w(0, 2) - w(2, 0), w(1, 0) - w(0, 1)};
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& w) {
  Eigen::Matrix3d cross;
  cross << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return cross;
}

// d loss / d A for R = PolarRotation(A).
Eigen::Matrix3d PolarRotationAdjoint(const Eigen::Matrix3d& a, const Eigen::Matrix3d& rotation,
                                     const Eigen::Matrix3d& rotation_bar) {
  // forward: A = R S, so dR = R [w]x with (tr S - S) w = SkewVector(R^T dA)
  const Eigen::Matrix3d s = rotation.transpose() * a;
  const Eigen::Matrix3d system = s.trace() * Eigen::Matrix3d::Identity() - s;
  const Eigen::Vector3d y =
      system.transpose().inverse() * SkewVector(rotation.transpose() * rotation_bar);
  return rotation * CrossMatrix(y);
}

// R <- polar(to from^T + inertia R), from R = I: each step removes nearly all of the error of a
// determined angle, and none of an open one.
struct RotationSteps {
  static constexpr int kSteps = 4;
  Eigen::Matrix3d covariance;
  double inertia;
  std::array<Eigen::Matrix3d, kSteps + 1> rotation;  // before and after each step

  RotationSteps(const Points& from, const Points& to)
      : covariance(to * from.transpose()), inertia(0.01 * from.squaredNorm()) {
    rotation[0].setIdentity();
    for (int step = 0; step < kSteps; ++step) {
      rotation[step + 1] = PolarRotation(covariance + inertia * rotation[step]);
    }
  }
};

}  // namespace

Eigen::Matrix3d FitRotation(const Points& from, const Points& to) {
  return RotationSteps(from, to).rotation[RotationSteps::kSteps];
}

Points MoveRigidly(const Points& from, const Points& to, const Points& points) {
  const Eigen::Vector3d old_centre = from.rowwise().mean(), centre = to.rowwise().mean();
  const Eigen::Matrix3d turn = FitRotation(from.colwise() - old_centre, to.colwise() - centre);
  return (turn * (points.colwise() - old_centre)).colwise() + centre;
}

void AddFitRotationAdjoint(const Points& from, const Points& to,
                           const Eigen::Matrix3d& rotation_bar, Points* to_bar) {
  const RotationSteps steps(from, to);
  Eigen::Matrix3d bar = rotation_bar, covariance_bar = Eigen::Matrix3d::Zero();
  for (int step = RotationSteps::kSteps - 1; step >= 0; --step) {
    // forward: rotation[step + 1] = polar(covariance + inertia rotation[step])
    const Eigen::Matrix3d a = steps.covariance + steps.inertia * steps.rotation[step];
    const Eigen::Matrix3d a_bar = PolarRotationAdjoint(a, steps.rotation[step + 1], bar);
    covariance_bar += a_bar;
    bar = steps.inertia * a_bar;
  }
  // forward: covariance = to from^T
  *to_bar += covariance_bar * from;
}

}  // namespace physpring
