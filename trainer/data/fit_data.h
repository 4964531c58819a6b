// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_DATA_FIT_DATA_H_
#define PHYSPRING_TRAINER_DATA_FIT_DATA_H_

#include <cstdint>
#include <vector>

#include "twin/dataset.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// Recordings of one object to fit. All have the same numbers of points, interior particles and
// controllers.
struct FitData {
  std::vector<Recording> recordings;
  // For each recording, the number of its run: recordings cut from the same run share one.
  std::vector<int> continuous_recording;
};

// Reads the recordings that are listed (dataset.h). One that names no continuous recording counts
// as one of its own. Throws Error if one cannot be read, or if it sees nothing after frame 0 in the
// frames for fitting. Throws Error that names both files if two differ in points, interior
// particles, controllers or frame rate.
FitData ReadFitData(const std::vector<RecordingEntry>& entries);

// The same for recordings that are read already. `entries` say where they come from.
FitData CollectFitData(const std::vector<RecordingEntry>& entries,
                       std::vector<Recording> recordings);

// The recordings by the clock of a twin (clock_offset.h).
FitData ByClockOf(const Twin& twin, FitData data);

// The dense twin of a recording's object, but for its number of sub-steps a second.
Twin DenseTwin(const Recording& recording, const SpringMassSystem& system, bool controller_velocity,
               std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DATA_FIT_DATA_H_
