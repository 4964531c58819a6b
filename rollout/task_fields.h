// SPDX-License-Identifier: Apache-2.0
// What `task.json` says in more than one place: lengths, angles, poses, boxes.
#ifndef PHYSPRING_ROLLOUT_TASK_FIELDS_H_
#define PHYSPRING_ROLLOUT_TASK_FIELDS_H_

#include <Eigen/Core>

#include "rollout/pose.h"
#include "twin/bounded_fields.h"
#include "twin/json_fields.h"

namespace physpring {

// A box about `pose.position`, turned by `pose.orientation`.
struct Box {
  Pose pose;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // m, of its edges
};

// A length, or a coordinate from 0, is at most this; degrees are a turn to either side.
constexpr double kFarthest = 1000;  // m
constexpr double kTurn = 360;

// Each throws Error unless the keys hold that, within the bounds.
Pose ReadPose(const JsonFields& fields);  // keys position, quaternion: both optional
Box ReadBox(const JsonFields& fields);    // keys position, size, yaw (degrees, optional)

double Radians(double degrees);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_TASK_FIELDS_H_
