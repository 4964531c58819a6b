// SPDX-License-Identifier: Apache-2.0
// The training loss of one frame (PhysTwin's two terms, with true counts):
//   chamfer  w_c / n  sum_i |x_nn(i) - g_i|^2       g: measured surface points, nn: nearest
//   particle track    w_t / 3n sum_i sum_xyz smoothL1(x_i - g_i)   g: measured points, by index,
//   seen ones only, each times its weight (Recording::weight)
// smoothL1(r) = r^2 / (2 beta) for |r| < beta, |r| - beta / 2 beyond.
#ifndef PHYSPRING_TRAINER_MOTION_LOSS_H_
#define PHYSPRING_TRAINER_MOTION_LOSS_H_

#include "twin/points.h"
#include "twin/recording.h"

namespace physpring {

struct LossOptions {
  double track_weight = 1;
  double chamfer_weight = 1;
  double track_beta = 1;  // m
};

// Loss of the particles at `position` (3 x nodes, points first) in frame `frame` of `recording`;
// adds its derivative to `position_bar`. Frames in which nothing was seen have loss 0.
double AddFrameLoss(const Points& position, const Recording& recording, int frame,
                    const LossOptions& options, Points* position_bar);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_LOSS_H_
