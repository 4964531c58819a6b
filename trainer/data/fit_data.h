// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_DATA_FIT_DATA_H_
#define PHYSPRING_TRAINER_DATA_FIT_DATA_H_

#include <cstdint>
#include <vector>

#include "twin/dataset.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// Recordings of one object to fit; all with the same numbers of points, interior and controllers.
struct FitData {
  std::vector<Recording> recordings;
  std::vector<int>
      continuous_recording;  // of each: recordings cut from the same run share a number
};

// Reads the recordings that are listed (dataset.h). Those of which nothing is said count as
// continuous recordings of their own. Throws Error if one cannot be read or sees nothing after
// frame 0 of what is for fitting, or naming both files if two differ in points, interior particles,
// controllers or frame rate.
FitData ReadFitData(const std::vector<RecordingEntry>& entries);

// The dense twin of a recording's object, but for its number of sub-steps a second.
Twin DenseTwin(const Recording& recording, const SpringMassSystem& system, bool controller_velocity,
               std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DATA_FIT_DATA_H_
