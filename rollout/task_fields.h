// SPDX-License-Identifier: Apache-2.0
// What `task.json` says in more than one place: lengths, angles, poses, boxes.
#ifndef PHYSPRING_ROLLOUT_TASK_FIELDS_H_
#define PHYSPRING_ROLLOUT_TASK_FIELDS_H_

#include <Eigen/Core>
#include <string>

#include "rollout/pose.h"
#include "twin/json_fields.h"

namespace physpring {

// A box about `pose.position`, turned by `pose.orientation`.
struct Box {
  Pose pose;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // m, of its edges
};

// Each throws Error unless the key holds that; those with a default take it where the key is
// missing.
double FiniteNumber(const JsonFields& fields, const std::string& key);
double PositiveNumber(const JsonFields& fields, const std::string& key, double missing);
Eigen::Vector3d ThreeNumbers(const JsonFields& fields, const std::string& key);
Pose ReadPose(const JsonFields& fields);  // keys position, quaternion: both optional
Box ReadBox(const JsonFields& fields);    // keys position, size, yaw (degrees, optional)

double Radians(double degrees);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_TASK_FIELDS_H_
