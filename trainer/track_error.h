// SPDX-License-Identifier: Apache-2.0
// What models are judged by: how far their motions are from measured ones.
#ifndef PHYSPRING_TRAINER_TRACK_ERROR_H_
#define PHYSPRING_TRAINER_TRACK_ERROR_H_

#include <vector>

#include "trainer/rollout.h"

namespace physpring {

// A motion to predict, and a recording of it with only those frames seen that judge the prediction.
struct JudgedEpisode {
  Episode episode;
  const Recording* seen;
};

// The geometric mean of their track errors [m], so that one in which a free motion loses its phase
// does not decide; infinite where a motion diverges. options.substeps of 0 are as many as are
// stable.
double GeometricTrackError(const SpringMassSystem& system,
                           const std::vector<JudgedEpisode>& episodes, RolloutOptions options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_TRACK_ERROR_H_
