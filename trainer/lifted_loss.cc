// SPDX-License-Identifier: Apache-2.0
#include "trainer/lifted_loss.h"

#include "trainer/loss.h"

namespace physpring {

std::optional<LiftedLoss> ComputeLiftedLoss(const LiftedMotion& motion,
                                            const SpringMassSystem& system) {
  const auto moved = motion.Run(system, motion.Substeps(system));
  if (!moved) return {};
  LiftedMotion::Frames bars = LiftedMotion::ZerosLike(moved->particles);
  double loss = 0;
  for (int e = 0; e < motion.episode_count(); ++e) {
    for (int frame = 1; frame < motion.frames(e); ++frame) {
      loss +=
          AddFrameLoss(moved->particles[e][frame], motion.recording(e), frame, {}, &bars[e][frame]);
    }
  }
  return LiftedLoss{loss, motion.Adjoint(system, *moved, bars, nullptr)};
}

}  // namespace physpring
