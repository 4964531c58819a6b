// SPDX-License-Identifier: Apache-2.0
// Names of points that a fit makes better. What follows clouds at first (followed_body.h) knows
// nothing of a body but its particles, so it takes some points for others, above all where a rope
// twists. A fit goes by the many that are right, and its prediction shows where the others are:
//   1. A twin is fitted to the first frames, as far as they are explained: at first to all that are
//      for fitting.
//   2. The frames are explained up to the first one in which the cloud is farther from the
//      prediction than usual, by more than a fifth of the particles' distance.
//   3. The clouds tell the points anew, near where they are predicted (told_points.h).
// It ends when all frames for fitting are explained.
#ifndef PHYSPRING_REGISTRATION_REFINE_NAMES_H_
#define PHYSPRING_REGISTRATION_REFINE_NAMES_H_

#include <functional>
#include <vector>

#include "registration/told_points.h"
#include "twin/recording.h"

namespace physpring {

inline constexpr int kMostNamingRounds = 6;

// Fits a twin to the recording; its predicted motion, T frames of 3 x particles, m. `round` counts
// from 0.
using FitAndPredict = std::function<std::vector<Points>(const Recording& recording, int round)>;

struct RefinedNames {
  RegisteredClouds registered;  // by the prediction that the clouds were nearest to
  int fits = 0;                 // rounds
  int explained = 0;            // frames, by the last prediction
};

RefinedNames RefineNames(const RegisteredClouds& first, const FitAndPredict& fit);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_REFINE_NAMES_H_
