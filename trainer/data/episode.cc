// SPDX-License-Identifier: Apache-2.0
#include "trainer/data/episode.h"

#include <algorithm>
#include <limits>

namespace physpring {

int SplitRecording::last(Use wanted) const {
  const auto found = std::find(use.rbegin(), use.rend(), wanted);
  return static_cast<int>(use.rend() - found);
}

int SplitRecording::seen(Use wanted) const {
  int count = 0;
  for (std::size_t frame = 0; frame < use.size(); ++frame) {
    count += use[frame] == wanted && !recording->points[frame].array().isNaN().all() ? 1 : 0;
  }
  return count;
}

SplitRecording UseAll(const Recording& recording, FrameUse use) {
  SplitRecording split{&recording, std::vector<FrameUse>(recording.points.size(), use)};
  split.use[0] = FrameUse::kNone;
  return split;
}

Recording OnlyFitFrames(const Episode& episode) {
  Recording part = *episode.recording;
  for (int frame = 1; frame < episode.frames; ++frame) {
    if (episode.UseOf(frame) == FrameUse::kFit) continue;
    part.points[static_cast<std::size_t>(frame)].setConstant(
        std::numeric_limits<double>::quiet_NaN());
  }
  return part;
}

}  // namespace physpring
