// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/waypoints.h"

#include <algorithm>

namespace physpring {
namespace {

Waypoint Commanded(const Eigen::VectorXd& robot) {
  Waypoint here;
  here.hand.position = robot.head<3>();
  here.hand.orientation = Eigen::Quaterniond(robot[3], robot[4], robot[5], robot[6]).normalized();
  here.gripper = robot[7];
  return here;
}

}  // namespace

void WaypointPolicy::Reset(std::uint64_t) {
  leg_ = 0;
  way_.clear();
  next_ = 0;
  elapsed_ = 0;
  arrived_ = false;
}

Eigen::VectorXd WaypointPolicy::Act(const Observation& observation) {
  if (leg_ == 0) from_ = Commanded(observation.robot);
  if (!arrived_ && next_ == way_.size()) {
    way_ = Plan(leg_++, observation);
    next_ = 0;
    elapsed_ = 0;
    arrived_ = way_.empty();
  }
  if (arrived_) return CartesianAction(from_.hand, from_.gripper);

  const Waypoint& to = way_[next_];
  ++elapsed_;
  const double s = std::min(1.0, static_cast<double>(elapsed_) / std::max(1, to.frames));
  const double smooth = s * s * (3 - 2 * s);
  const Pose hand{from_.hand.position + smooth * (to.hand.position - from_.hand.position),
                  from_.hand.orientation.slerp(smooth, to.hand.orientation)};
  const double gripper = from_.gripper + smooth * (to.gripper - from_.gripper);
  if (elapsed_ >= to.frames) {
    from_ = to;
    ++next_;
    elapsed_ = 0;
  }
  return CartesianAction(hand, gripper);
}

}  // namespace physpring
