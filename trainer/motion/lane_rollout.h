// SPDX-License-Identifier: Apache-2.0
// Rollouts of several systems on one recording, side by side (twin/lane_simulator.h): what RollOut
// gives for each of them, with the same bits, in less time. There is no adjoint.
#ifndef PHYSPRING_TRAINER_MOTION_LANE_ROLLOUT_H_
#define PHYSPRING_TRAINER_MOTION_LANE_ROLLOUT_H_

#include <optional>
#include <vector>

#include "trainer/motion/rollout.h"

namespace physpring {

// For each system the positions in all frames (Rollout::positions), or nothing where it diverges.
// They go side by side where the processor has registers for that and the systems are alike, else
// one after the other. No kicks.
std::vector<std::optional<std::vector<Points>>> RollOutSideBySide(
    const std::vector<SpringMassSystem>& systems, const Episode& episode,
    const RolloutOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_LANE_ROLLOUT_H_
