// SPDX-License-Identifier: Apache-2.0
// Cloth folding: pinches the cloth beside one place, lifts it and lays the place onto another one.
// The places are the first pair of the task's success rule.
#ifndef PHYSPRING_ROLLOUT_POLICIES_CLOTH_FOLDING_H_
#define PHYSPRING_ROLLOUT_POLICIES_CLOTH_FOLDING_H_

#include "rollout/policies/waypoints.h"

namespace physpring {

class ClothFolding : public WaypointPolicy {
 public:
  explicit ClothFolding(const Task& task);

 protected:
  std::vector<Waypoint> Plan(int leg, const Observation& observation) override;

 private:
  int taken_, target_;  // particles
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_CLOTH_FOLDING_H_
