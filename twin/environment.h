// SPDX-License-Identifier: Apache-2.0
// What surrounds a twin in a simulation: gravity, the ground, and moving rigid geoms.
#ifndef PHYSPRING_TWIN_ENVIRONMENT_H_
#define PHYSPRING_TWIN_ENVIRONMENT_H_

#include <optional>
#include <vector>

#include "twin/points.h"
#include "twin/recording.h"

namespace physpring {

// A kinematic rigid geom: a box with rounded edges, all points within `radius` of the box of
// `half_size`. Sphere: half_size 0. Capsule along z: half_size (0, 0, h). Box: radius 0.
// The pose holds at the start of the frame; it moves on with the given velocities.
struct Geom {
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();         // m
  double radius = 0;                                           // m
  Eigen::Vector3d position = Eigen::Vector3d::Zero();          // m
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();      // geom to world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s, world axes
};

struct Environment {
  Eigen::Vector3d gravity{0, 0, -9.81};   // m/s^2
  std::optional<Eigen::Vector4d> ground;  // (a, b, c, d): a x + b y + c z = d, |(a,b,c)| = 1
};

inline Environment EnvironmentOf(const Recording& recording) {
  return {recording.gravity, recording.ground};
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_ENVIRONMENT_H_
