// SPDX-License-Identifier: Apache-2.0
// Where and with which random numbers an episode begins.
#ifndef PHYSPRING_ROLLOUT_START_H_
#define PHYSPRING_ROLLOUT_START_H_

#include <cstdint>

#include "rollout/task.h"

namespace physpring {

struct EpisodeStart {
  int episode = 0;
  std::uint64_t seed = 0;  // where the policy's random numbers start
  Pose object;             // where the twin's reference configuration is in the scene
  Eigen::Vector3d action_offset = Eigen::Vector3d::Zero();  // m, added to Cartesian actions
};

// What makes episodes harder, or a little different.
struct Disturbance {
  double action = 0;  // m, standard deviation of x and y of the actions' offset: an error of the
                      // hand's place, as a camera that is calibrated badly gives; a hand finds the
                      // table's height by touch
  double start = 0;   // m, by which the object lies elsewhere, in a random direction
};

// Depends on the arguments only: the same for every level. The start's disturbance changes nothing
// else, so that its effect alone can be measured (an A/A control).
EpisodeStart StartOf(const Task& task, std::uint64_t seed, int episode,
                     const Disturbance& disturbance);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_START_H_
