// SPDX-License-Identifier: Apache-2.0
// What is predicted of a recording, and which of its frames count.
#ifndef PHYSPRING_TRAINER_DATA_EPISODE_H_
#define PHYSPRING_TRAINER_DATA_EPISODE_H_

#include <cmath>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// Whether a frame is fitted, or held back to judge by, or neither.
enum class FrameUse { kNone, kFit, kHeld };

// The motion of a recording from its start up to frame `frames` - 1. Without a list of uses, all
// frames but the first one, the start, are fitted. An observer sees the frames that are in use.
struct Episode {
  const Recording* recording;
  int frames;  // >= 2; with fewer there is nothing to predict
  const std::vector<FrameUse>* use = nullptr;
  bool before_change = false;  // of the object before it got the effects that are looked for

  FrameUse UseOf(int frame) const {
    return use ? (*use)[static_cast<std::size_t>(frame)] : FrameUse::kFit;
  }
};

// A recording with the use of each of its frames. Frame 0 has none: it is the start.
struct SplitRecording {
  using Use = FrameUse;
  const Recording* recording;
  std::vector<Use> use;
  bool before_change = false;  // as of an episode

  int last(Use wanted) const;  // the last frame of that use + 1; 0 if there is none
  int seen(Use wanted) const;  // how many frames of that use see a point

  // The episode of all frames, or of the first ones. *this must outlive it.
  Episode All() const { return First(static_cast<int>(use.size())); }
  Episode First(int frames) const { return {recording, frames, &use, before_change}; }
};

// The recording with all frames but the start for one use.
SplitRecording UseAll(const Recording& recording, FrameUse use);

// A copy of the recording for functions that take no episode: after frame 0, those of the episode's
// frames that are not fitted are not seen in it.
Recording OnlyFitFrames(const Episode& episode);

// Calls visit(frame, point) for everything seen in frames of that use, in a fixed order.
template <class Visit>
void ForEachSeen(const Episode& episode, FrameUse use, Visit visit) {
  for (int frame = 1; frame < episode.frames; ++frame) {
    if (episode.UseOf(frame) != use) continue;
    const Points& measured = episode.recording->points[static_cast<std::size_t>(frame)];
    for (int i = 0; i < measured.cols(); ++i) {
      if (!std::isnan(measured(0, i))) visit(frame, i);
    }
  }
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DATA_EPISODE_H_
