// SPDX-License-Identifier: Apache-2.0
#include "rollout/pose.h"

namespace physpring {

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

Eigen::Quaterniond Yaw(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

}  // namespace physpring
