// SPDX-License-Identifier: Apache-2.0
// A scripted policy that takes the hand through a list of poses, planned from what is seen in frame
// 0 and, if the script wants, planned again on the way.
#ifndef PHYSPRING_ROLLOUT_POLICIES_WAYPOINTS_H_
#define PHYSPRING_ROLLOUT_POLICIES_WAYPOINTS_H_

#include <vector>

#include "rollout/policy.h"

namespace physpring {

// The hand reaches `hand` and `gripper` after `frames` frames, from the waypoint before: position
// and gripper along a smooth step (3 s^2 - 2 s^3), orientation along the shortest turn.
struct Waypoint {
  Pose hand;
  double gripper = 0;  // 0 open to 1 closed
  int frames = 30;
};

class WaypointPolicy : public Policy {
 public:
  void Reset(std::uint64_t seed) override;
  Eigen::VectorXd Act(const Observation& observation) override;

 protected:
  // The way from here: `leg` is 0 at the start, then counts the calls. Called in frame 0 and
  // whenever the way before is at its end; an empty one: stay there for good.
  virtual std::vector<Waypoint> Plan(int leg, const Observation& observation) = 0;

 private:
  int leg_ = 0;
  std::vector<Waypoint> way_;
  std::size_t next_ = 0;  // waypoint that the hand is on its way to
  int elapsed_ = 0;       // frames since the waypoint before
  bool arrived_ = false;  // for good
  Waypoint from_;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_WAYPOINTS_H_
