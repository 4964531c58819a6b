// SPDX-License-Identifier: Apache-2.0
// A walk along a recording, a frame at a time. The derivatives of each frame's loss reach back to
// the start of that frame and no further: what was before is taken as given. PhysTwin trains in
// this way. The parameters may change from one frame to the next.
#ifndef PHYSPRING_TRAINER_MOTION_FRAME_WALK_H_
#define PHYSPRING_TRAINER_MOTION_FRAME_WALK_H_

#include <memory>
#include <optional>

#include "trainer/motion/loss.h"
#include "trainer/motion/rollout.h"
#include "twin/recording.h"
#include "twin/simulator.h"

namespace physpring {

class FrameWalk {
 public:
  virtual ~FrameWalk() = default;

  // Goes on to the next frame with the parameters of `system` (the same topology each time).
  // Returns the loss there and adds its derivatives to `gradient`; nothing if the motion diverged.
  virtual std::optional<double> Step(const SpringMassSystem& system, SystemGradient* gradient) = 0;
};

// A walk that stands at frame 0 of `recording`, which must outlive it.
std::unique_ptr<FrameWalk> StartWalk(const SpringMassSystem& system, const Recording& recording,
                                     const RolloutOptions& options, const LossOptions& loss);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_FRAME_WALK_H_
