// SPDX-License-Identifier: Apache-2.0
// What `task.json` says in more than one place: lengths, angles, poses, boxes.
#ifndef PHYSPRING_ROLLOUT_TASK_FIELDS_H_
#define PHYSPRING_ROLLOUT_TASK_FIELDS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rollout/pose.h"
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

// Each throws Error unless the key holds that, within the bounds; those with a default take it
// where the key is missing.
double NumberBetween(const JsonFields& fields, const std::string& key, double least, double most);
std::vector<double> NumbersBetween(const JsonFields& fields, const std::string& key, double least,
                                   double most);
double PositiveNumber(const JsonFields& fields, const std::string& key, double most);
double PositiveNumberOr(const JsonFields& fields, const std::string& key, double missing,
                        double most);
int CountBetween(const JsonFields& fields, const std::string& key, int least, int most);
Pose ReadPose(const JsonFields& fields);  // keys position, quaternion: both optional
Box ReadBox(const JsonFields& fields);    // keys position, size, yaw (degrees, optional)

double Radians(double degrees);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_TASK_FIELDS_H_
