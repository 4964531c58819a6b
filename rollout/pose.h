// SPDX-License-Identifier: Apache-2.0
// Where a rigid thing is: x = orientation * x_local + position.
#ifndef PHYSPRING_ROLLOUT_POSE_H_
#define PHYSPRING_ROLLOUT_POSE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/points.h"

namespace physpring {

struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m
  Eigen::Quaterniond orientation = Eigen::Quaterniond(1, 0, 0, 0);  // unit

  // From coordinates in this pose to those around it, and back.
  Points ToWorld(const Points& local) const;
  Points ToLocal(const Points& world) const;
};

// First `inner`, then `outer`.
Pose operator*(const Pose& outer, const Pose& inner);

// What follows is written out operation by operation, as python/examples/task_env.py has it: a
// simulation with contacts is only the same elsewhere if its input is, to the last bit.

// The unit quaternion along w, x, y, z.
Eigen::Quaterniond UnitQuaternion(double w, double x, double y, double z);

// The angle [rad] that turns one orientation into the other.
double AngleBetween(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second);

// Along the shortest turn from a (share 0) to b (1).
Eigen::Quaterniond Slerp(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double share);

// A turn about the vertical axis z, by `angle` [rad].
Eigen::Quaterniond Yaw(double angle);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POSE_H_
