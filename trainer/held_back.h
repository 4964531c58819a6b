// SPDX-License-Identifier: Apache-2.0
// What a choice (neighbour count, start values) is fitted on and what it is judged by: part of the
// fit frames is held back. Frames from train_frames on are never touched.
#ifndef PHYSPRING_TRAINER_HELD_BACK_H_
#define PHYSPRING_TRAINER_HELD_BACK_H_

#include <vector>

#include "trainer/fitter.h"
#include "trainer/rollout.h"

namespace physpring {

// Frames first .. last - 1 of a rollout from the recording's start.
struct ScoredFrames {
  const Recording* recording;
  int first, last;
};

struct HeldBack {
  std::vector<Episode> fit;
  std::vector<ScoredFrames> scored;
};

// With four or more continuous runs, whole runs are held back (a quarter of them, spread evenly);
// otherwise the last quarter of each recording's fit frames. At most `most` recordings on each
// side, spread evenly.
HeldBack HoldBack(const FitData& data, int most);

// All fit frames of at most `most` recordings, spread evenly.
std::vector<Episode> FitEpisodes(const FitData& data, int most);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_HELD_BACK_H_
