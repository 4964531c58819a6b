// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/hand_down.h"

#include <cmath>
#include <numbers>

namespace physpring {

double HalfTurnNear(double yaw, double about) {
  const double pi = std::numbers::pi;
  return yaw - pi * std::round((yaw - about) / pi);
}

Waypoint HandDown(const Eigen::Vector3d& position, double yaw, double gripper, int frames) {
  return {{position, Yaw(yaw)}, gripper, frames};
}

Eigen::Vector3d MeanWhere(const Points& particles,
                          const Eigen::Array<bool, Eigen::Dynamic, 1>& chosen) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (Eigen::Index i = 0; i < particles.cols(); ++i) {
    if (!chosen[i]) continue;
    sum += particles.col(i);
    ++count;
  }
  if (count == 0 || !sum.allFinite()) throw PolicyError("finds no such place on the object");
  return sum / count;
}

double YawBetween(const Points& reference, const Points& points) {
  const Points a = reference.colwise() - reference.rowwise().mean();
  const Points b = points.colwise() - points.rowwise().mean();
  const double along = (a.topRows<2>().array() * b.topRows<2>().array()).sum();
  const double across =
      (a.row(0).array() * b.row(1).array() - a.row(1).array() * b.row(0).array()).sum();
  const double yaw = std::atan2(across, along);
  if (!std::isfinite(yaw)) throw PolicyError("does not see the object");
  return yaw;
}

}  // namespace physpring
