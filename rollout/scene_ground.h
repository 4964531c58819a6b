// SPDX-License-Identifier: Apache-2.0
// The grounds of a MuJoCo scene, to compare with that of a recording.
#ifndef PHYSPRING_ROLLOUT_SCENE_GROUND_H_
#define PHYSPRING_ROLLOUT_SCENE_GROUND_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// The planes that are fixed in the world and that something can collide with, as in ground.h.
// mj_kinematics must have run.
std::vector<Eigen::Vector4d> GroundsOf(const mjModel& model, const mjData& data);

// In what the grounds of a scene are others than the recording's, for people; empty if they are
// not.
std::string OtherGround(const mjModel& model, const mjData& data, const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SCENE_GROUND_H_
