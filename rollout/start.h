// SPDX-License-Identifier: Apache-2.0
// Where and with which random numbers an episode begins.
#ifndef PHYSPRING_ROLLOUT_START_H_
#define PHYSPRING_ROLLOUT_START_H_

#include <cstdint>

#include "rollout/task.h"

namespace physpring {

struct EpisodeStart {
  int episode = 0;
  std::uint64_t seed = 0;  // of the policy's random numbers
  Pose object;             // of the twin's reference configuration in the scene
  Eigen::Vector3d action_offset = Eigen::Vector3d::Zero();  // m, added to Cartesian actions
};

// Depends on task, seed and number only: the same for every level. `action_noise` [m]: standard
// deviation of each coordinate of the action's offset, as a camera that is calibrated badly gives.
EpisodeStart StartOf(const Task& task, std::uint64_t seed, int episode, double action_noise);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_START_H_
