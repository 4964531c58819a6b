// SPDX-License-Identifier: Apache-2.0
// The pieces of which a policy's state is put together: numbers of the robot, the object and the
// sensors, each by its name.
#ifndef PHYSPRING_ROLLOUT_POLICIES_STATE_PART_H_
#define PHYSPRING_ROLLOUT_POLICIES_STATE_PART_H_

#include <string>
#include <vector>

#include "rollout/policy.h"
#include "twin/json_fields.h"

namespace physpring {

// Where a policy has its axes. A pose of the hand h is base^-1 * h * tool to the policy.
struct PolicyFrames {
  Pose base;  // of what it takes for the world, in the scene
  Pose tool;  // of what it takes for the hand, in the task's hand
};

struct StatePart {
  // robot: Observation::robot as it is
  // position (3, m), quaternion_wxyz, quaternion_xyzw (4), axis_angle (3, rad): of the hand
  // joints: positions of the driven joints but the gripper's
  // gripper (1): as measured, `open` to `closed`
  // particles (3 a particle, m): of level 0; `count` of them, evenly spaced by their numbers
  // sensor: what the scene's sensor `sensor` reads
  std::string name;
  double open = 0, closed = 1;
  int count = 0;  // 0: all
  std::string sensor;
};

// Throws Error, beginning as `fields` does, for a part that is unknown or that the task lacks.
StatePart ReadStatePart(const JsonFields& fields, const Task& task);

// Adds the part's numbers to `state`.
void AddState(const StatePart& part, const Observation& observation, const PolicyFrames& frames,
              std::vector<double>* state);

// The vector along the axis of a turn, as long as its angle [rad], 0 to pi.
Eigen::Vector3d AxisAngle(const Eigen::Quaterniond& turn);
Eigen::Quaterniond TurnAlong(const Eigen::Vector3d& axis_angle);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_STATE_PART_H_
