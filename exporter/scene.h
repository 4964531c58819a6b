// SPDX-License-Identifier: Apache-2.0
// scene.xml: a level in a scene of its own, with all that a level leaves to the scene: time step,
// integrator, gravity, floor, light, camera `view`, keyframes `home` and `test`.
#ifndef PHYSPRING_EXPORTER_SCENE_H_
#define PHYSPRING_EXPORTER_SCENE_H_

#include <Eigen/Core>
#include <optional>
#include <string>

#include "exporter/level_plan.h"

namespace physpring {

// The ground of a scene: the one that the twin was trained with, or none. Where the twin's file
// does not say, a guess: at height 0, or below the object where that is lower, across gravity.
std::optional<Eigen::Vector4d> GroundOf(const LevelPlan& plan);

// `level_file` is what it includes. The floor is the twin's ground; there is none if it had none.
std::string FormatScene(const LevelPlan& plan, const std::string& level_file);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_SCENE_H_
