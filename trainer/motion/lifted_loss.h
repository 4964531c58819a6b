// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_MOTION_LIFTED_LOSS_H_
#define PHYSPRING_TRAINER_MOTION_LIFTED_LOSS_H_

#include <optional>

#include "trainer/motion/lifted_motion.h"

namespace physpring {

struct LiftedLoss {
  double loss = 0;          // the sum over the frames
  SystemGradient gradient;  // the gradient of that sum
};

// The training loss (loss.h) of the lifted particles in the fitted frames of all episodes, and its
// derivatives with respect to the level's system. Nothing where the motion diverges.
std::optional<LiftedLoss> ComputeLiftedLoss(const LiftedMotion& motion,
                                            const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_LIFTED_LOSS_H_
