// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/lifted_loss.h"

#include "trainer/motion/loss.h"

namespace physpring {

std::optional<LiftedLoss> ComputeLiftedLoss(const LiftedMotion& motion,
                                            const SpringMassSystem& system) {
  const auto moved = motion.Run(system, motion.SubstepsOf(system));
  if (!moved) return {};
  std::vector<std::vector<Points>> bars;
  double loss = 0;
  for (int e = 0; e < motion.episode_count(); ++e) {
    const std::vector<Points>& particles = (*moved)[e].particles();
    bars.push_back(LiftedMotion::ZerosLike(particles));
    const Episode& episode = motion.episode(e);
    LossOptions options;
    for (int frame = 1; frame < episode.frames; ++frame) {
      // a surface measured apart from the points counts in all frames
      const bool fitted = episode.UseOf(frame) == FrameUse::kFit;
      options.track_weight = fitted ? 1 : 0;
      options.chamfer_weight = fitted || !episode.recording->surface.empty() ? 1 : 0;
      loss += AddFrameLoss(particles[frame], *episode.recording, frame, options, &bars[e][frame]);
    }
  }
  return LiftedLoss{loss, motion.Adjoint(
                              system, *moved, [&](int e) { return bars[e]; }, nullptr)};
}

}  // namespace physpring
