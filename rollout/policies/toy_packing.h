// SPDX-License-Identifier: Apache-2.0
// Toy packing: takes the toy across its middle, carries it over the box and lets it fall in. The
// box is that of the task's success rule, open upwards.
#ifndef PHYSPRING_ROLLOUT_POLICIES_TOY_PACKING_H_
#define PHYSPRING_ROLLOUT_POLICIES_TOY_PACKING_H_

#include "rollout/policies/waypoints.h"
#include "rollout/task_fields.h"

namespace physpring {

class ToyPacking : public WaypointPolicy {
 public:
  explicit ToyPacking(const Task& task);

 protected:
  std::vector<Waypoint> Plan(int leg, const Observation& observation) override;

 private:
  Box box_;
  Points reference_;  // where the particles are if the toy's long side is along x
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_TOY_PACKING_H_
