// SPDX-License-Identifier: Apache-2.0
#include "rollout/policy.h"

namespace physpring {

Eigen::VectorXd CartesianAction(const Pose& hand, double gripper) {
  const Eigen::Quaterniond& q = hand.orientation;
  Eigen::VectorXd action(8);
  action << hand.position, q.w(), q.x(), q.y(), q.z(), gripper;
  return action;
}

}  // namespace physpring
