// SPDX-License-Identifier: Apache-2.0
// A twin on a recording of its object: the motion that it predicts from the start positions and
// velocities, the controllers' motion, gravity and ground of the recording. Masses, rest lengths
// and all parameters stay the twin's. Particles match by index.
#ifndef PHYSPRING_TWIN_PREDICT_H_
#define PHYSPRING_TWIN_PREDICT_H_

#include <vector>

#include "twin/points.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct PredictOptions {
  bool single_precision = false;
  int substeps = 0;  // a frame; 0: ChooseSubsteps
};

// Sub-steps of a frame at `fps` frames per second: `requested` if that is more than 0, else as many
// as kStepSafety asks for, and never a longer one than the level was trained with.
int ChooseSubsteps(const TwinLevel& level, double fps, int requested);

// Throws Error, naming both numbers, unless the recording has as many points, interior particles
// and controllers as the twin.
void ExpectSameObject(const Twin& twin, const Recording& recording);

// Positions of the level's free nodes in every frame of the recording: T frames of 3 x nodes, m.
// Nodes of a coarse level start at the mass-weighted means of their members. Throws Error if the
// recording does not fit the twin, or naming the frame in which the motion leaves all bounds
// (IsFarAway).
std::vector<Points> Predict(const Twin& twin, int level, const Recording& recording,
                            const PredictOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_PREDICT_H_
