// SPDX-License-Identifier: Apache-2.0
// Nodes and controllers as MJCF bodies.
//
// A node is a body on three slide joints: qpos is its displacement from the reference
// configuration. All nodes are children of one fixed body, in order. Drag is joint damping
//   c = m (exp(h drag) - 1) / h,
// which is exact: MuJoCo takes joint damping implicitly, v' = (m v + h F) / (m + h c). A controller
// is a mocap body, or a body on three slide joints that position actuators drive: their gains
//   kp = m / H^2, kv = m / H
// take it to `ctrl` within one time step H, with the velocity that leads there.
#ifndef PHYSPRING_EXPORTER_BODIES_H_
#define PHYSPRING_EXPORTER_BODIES_H_

#include "exporter/level_plan.h"
#include "exporter/xml.h"

namespace physpring {

// Default classes NAME, NAME_node and NAME_controller under `mujoco`.
void AddDefaults(const LevelPlan& plan, XmlElement* mujoco);

// The parent body with its nodes.
void AddNodes(const LevelPlan& plan, XmlElement* worldbody);

// The controllers, children of the world as mocap bodies must be, ...
void AddControllers(const LevelPlan& plan, XmlElement* worldbody);

// ... and what drives them; nothing for mocap bodies.
void AddActuators(const LevelPlan& plan, XmlElement* mujoco);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_BODIES_H_
