// SPDX-License-Identifier: Apache-2.0
// Rope routing: lays the rope through the slot of a clip, taut between a place behind it and one in
// front of it. It grasps the rope near the end that lies further along the slot, puts it down
// beyond the slot; then grasps it again further back, lifts it over the clip's walls and pulls it
// down on the near side.
//
// The slot is the box of the task's success rule, open along its y and upwards.
#ifndef PHYSPRING_ROLLOUT_POLICIES_ROPE_ROUTING_H_
#define PHYSPRING_ROLLOUT_POLICIES_ROPE_ROUTING_H_

#include "rollout/policies/waypoints.h"
#include "rollout/task_fields.h"

namespace physpring {

class RopeRouting : public WaypointPolicy {
 public:
  explicit RopeRouting(const Task& task);

 protected:
  std::vector<Waypoint> Plan(int leg, const Observation& observation) override;

 private:
  // Mean position of the particles about `arc` [m] from the rope's end.
  Eigen::Vector3d Section(const Points& particles, double arc) const;
  // Takes the rope at `arc`, coming from `height` above the table.
  std::vector<Waypoint> Grasp(const Points& particles, double arc, double height) const;
  // The hand at a place in the slot's frame (z above the table), across the rope.
  Waypoint InSlotFrame(double x, double y, double z, double gripper, int frames) const;

  Box slot_;
  double slot_yaw_;      // rad, of the direction in which the rope is to pass
  Eigen::VectorXd arc_;  // (particles), m from the end that is taken first
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_ROPE_ROUTING_H_
