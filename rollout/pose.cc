// SPDX-License-Identifier: Apache-2.0
#include "rollout/pose.h"

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

// The cosine of half the angle between two orientations, or its negative.
double Cosine(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.w() * b.w() + a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

}  // namespace

Points Pose::ToWorld(const Points& local) const {
  return (orientation.toRotationMatrix() * local).colwise() + position;
}

Points Pose::ToLocal(const Points& world) const {
  return orientation.toRotationMatrix().transpose() * (world.colwise() - position);
}

Pose operator*(const Pose& outer, const Pose& inner) {
  return {outer.position + outer.orientation * inner.position,
          (outer.orientation * inner.orientation).normalized()};
}

Eigen::Quaterniond UnitQuaternion(double w, double x, double y, double z) {
  const double norm = std::sqrt(w * w + x * x + y * y + z * z);
  return {w / norm, x / norm, y / norm, z / norm};
}

double AngleBetween(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second) {
  return 2 * std::acos(std::min(1.0, std::abs(Cosine(first, second))));
}

Eigen::Quaterniond Slerp(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double share) {
  const double cosine = Cosine(a, b);
  double from = 1 - share, to = share;
  constexpr double kSame = 1 - 1e-15;
  if (std::abs(cosine) < kSame) {
    const double angle = std::acos(std::abs(cosine)), sine = std::sin(angle);
    from = std::sin((1 - share) * angle) / sine;
    to = std::sin(share * angle) / sine;
  }
  if (cosine < 0) to = -to;
  return {from * a.w() + to * b.w(), from * a.x() + to * b.x(), from * a.y() + to * b.y(),
          from * a.z() + to * b.z()};
}

Eigen::Quaterniond Yaw(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

}  // namespace physpring
