// SPDX-License-Identifier: Apache-2.0
// What models are judged by: how far their motions are from measured ones, in frames of one use.
#ifndef PHYSPRING_TRAINER_MOTION_TRACK_ERROR_H_
#define PHYSPRING_TRAINER_MOTION_TRACK_ERROR_H_

#include <functional>
#include <vector>

#include "trainer/motion/rollout.h"

namespace physpring {

// Mean distance, m, of predicted from measured points of each frame of one use, in order, each
// point by its weight (Recording::weight); frames in which nothing was seen are left out.
using FrameTrack = std::vector<double>;

// `particles` are the predicted positions in each frame.
FrameTrack TrackOf(const Episode& episode, FrameUse use, const std::vector<Points>& particles);

double Mean(const FrameTrack& track);  // NaN if it is empty

// The mean over the frames; 0 where nothing was seen.
double MeanTrackError(const Episode& episode, FrameUse use, const std::vector<Points>& particles);

// Rolls the system out on each episode in turn and shows the particles' positions to `visit`;
// false, and no further, where a motion diverges. options.substeps of 0 are as many as are stable.
bool VisitMotions(
    const SpringMassSystem& system, const std::vector<Episode>& episodes, RolloutOptions options,
    const std::function<void(const Episode&, const std::vector<Points>& particles)>& visit);

// The geometric mean of the episodes' track errors [m], so that one in which a free motion loses
// its phase does not decide; infinite where a motion diverges. options.substeps of 0 are as many as
// are stable.
double GeometricTrackError(const SpringMassSystem& system, const std::vector<Episode>& episodes,
                           FrameUse use, RolloutOptions options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_TRACK_ERROR_H_
