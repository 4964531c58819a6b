// SPDX-License-Identifier: Apache-2.0
// The pieces of which a policy's action is put together, and what they make of ours: absolute
// poses, or controls of joints.
#ifndef PHYSPRING_ROLLOUT_POLICIES_ACTION_PART_H_
#define PHYSPRING_ROLLOUT_POLICIES_ACTION_PART_H_

#include <limits>
#include <string>
#include <vector>

#include "rollout/policies/state_part.h"

namespace physpring {

struct ActionPart {
  // robot: an action of the task as it is
  // position (3, m), quaternion_wxyz, quaternion_xyzw (4), axis_angle (3, rad): where the hand goes
  // position_delta (3), axis_angle_delta (3): from where it is, along the axes of the base
  // joints, joint_delta (rad or m), joint_velocity (per second): of the joints but the gripper's
  // gripper (1): `open` to `closed`; `binary`: whatever is nearer
  // unused (`count`)
  std::string name;
  double scale = 1;  // of deltas and velocities
  double open = 0, closed = 1;
  bool binary = false;
  int count = 1;
};

struct ActionLayout {
  std::vector<ActionPart> parts;
  double clip = std::numeric_limits<double>::infinity();  // all numbers are from -clip to clip
  bool from_command = false;  // deltas are from the action before, not from what is measured
};

// Throws Error, beginning as `fields` does, for a part that is unknown or not for this robot.
ActionPart ReadActionPart(const JsonFields& fields, const RobotOptions& robot);

// How many numbers a policy gives.
int SizeOf(const ActionLayout& layout, const RobotOptions& robot);

struct ActionContext {
  const RobotOptions& robot;
  const PolicyFrames& frames;
  const Observation& observation;
  const Eigen::VectorXd& command;  // the action before; at first, where the robot is
  double seconds;                  // that the action lasts
};

// The task's action for the policy's `numbers`. What no part tells stays as commanded.
Eigen::VectorXd ToAction(const ActionLayout& layout, const Eigen::VectorXd& numbers,
                         const ActionContext& context);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_ACTION_PART_H_
