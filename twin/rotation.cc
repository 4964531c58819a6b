// SPDX-License-Identifier: Apache-2.0
#include "twin/rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <array>

namespace physpring {
namespace {

// R in A = R S, det R = 1.
Eigen::Matrix3d PolarRotation(const Eigen::Matrix3d& a) {
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
