// SPDX-License-Identifier: Apache-2.0
// What is predicted of a recording, and which of its frames count.
#ifndef PHYSPRING_TRAINER_EPISODE_H_
#define PHYSPRING_TRAINER_EPISODE_H_

#include <cmath>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// Whether a frame is fitted, or held back to judge by, or neither.
enum class FrameUse { kNone, kFit, kHeld };

// The motion of a recording from its start up to frame `frames` - 1. Without a list of uses all
// frames but the first one, the start, are fitted.
struct Episode {
  const Recording* recording;
  int frames;  // >= 2; fewer: there is nothing to predict
  const std::vector<FrameUse>* use = nullptr;

  bool Counts(int frame, FrameUse as) const {
    return (use ? (*use)[static_cast<std::size_t>(frame)] : FrameUse::kFit) == as;
  }
};

// Calls visit(frame, point) for everything seen in frames of that use, in a fixed order.
template <class Visit>
void ForEachSeen(const Episode& episode, FrameUse use, Visit visit) {
  for (int frame = 1; frame < episode.frames; ++frame) {
    if (!episode.Counts(frame, use)) continue;
    const Points& measured = episode.recording->points[static_cast<std::size_t>(frame)];
    for (int i = 0; i < measured.cols(); ++i) {
      if (!std::isnan(measured(0, i))) visit(frame, i);
    }
  }
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_EPISODE_H_
