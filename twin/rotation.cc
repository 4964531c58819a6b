// SPDX-License-Identifier: Apache-2.0
#include "twin/rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace physpring {
namespace {

// R in A = R S, det R = 1.
Eigen::Matrix3d PolarRotation(const Eigen::Matrix3d& a) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

}  // namespace

Eigen::Matrix3d FitRotation(const Points& from, const Points& to) {
  // R <- polar(to from^T + inertia R), from R = I: each step removes nearly all of the error of a
  // determined angle, and none of an open one
  const Eigen::Matrix3d covariance = to * from.transpose();
  const double inertia = 0.01 * from.squaredNorm();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int step = 0; step < 4; ++step) {
    rotation = PolarRotation(covariance + inertia * rotation);
  }
  return rotation;
}

}  // namespace physpring
