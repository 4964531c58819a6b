// SPDX-License-Identifier: Apache-2.0
// scene.xml: a level in a scene of its own, with all that a level leaves to the scene: time step,
// integrator, gravity, floor, light, camera `view`, keyframes `home` and `test`.
#ifndef PHYSPRING_EXPORTER_SCENE_H_
#define PHYSPRING_EXPORTER_SCENE_H_

#include <string>

#include "exporter/level_plan.h"

namespace physpring {

// `level_file` is what it includes. The floor is at height 0, or below the object where that is
// lower, across gravity.
std::string FormatScene(const LevelPlan& plan, const std::string& level_file);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_SCENE_H_
