// SPDX-License-Identifier: Apache-2.0
// T push: pushes the object towards the pose of the task's success rule, one short straight push
// after another, each planned from where the object is then. A push passes beside the centre by an
// amount that turns the object the right way.
#ifndef PHYSPRING_ROLLOUT_POLICIES_T_PUSH_H_
#define PHYSPRING_ROLLOUT_POLICIES_T_PUSH_H_

#include "rollout/policies/waypoints.h"

namespace physpring {

class TPush : public WaypointPolicy {
 public:
  explicit TPush(const Task& task);

 protected:
  std::vector<Waypoint> Plan(int leg, const Observation& observation) override;

 private:
  Points target_;  // where the particles should be, m
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_T_PUSH_H_
