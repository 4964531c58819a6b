// SPDX-License-Identifier: Apache-2.0
// Springs as spatial tendons, from site to site: one a spring, in order, with its own stiffness,
// damping and rest length. MuJoCo's law is the twin's: F = k (l - L) + c dl/dt.
#ifndef PHYSPRING_EXPORTER_TENDONS_H_
#define PHYSPRING_EXPORTER_TENDONS_H_

#include <vector>

#include "exporter/level_plan.h"
#include "exporter/xml.h"

namespace physpring {

// Those springs, by number, with what effects make of them.
void AddTendons(const LevelPlan& plan, const std::vector<int>& springs, XmlElement* mujoco);

// The springs of effects that hold nodes to places of the world.
void AddAnchors(const LevelPlan& plan, XmlElement* mujoco);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_TENDONS_H_
