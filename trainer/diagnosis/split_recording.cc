// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/split_recording.h"

#include <algorithm>

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr double kHeldBlock = 0.3;  // s

}  // namespace

int SplitRecording::last(Use wanted) const {
  const auto found = std::find(use.rbegin(), use.rend(), wanted);
  return static_cast<int>(use.rend() - found);
}

SplitRecording UseAll(const Recording& recording, Use use) {
  SplitRecording split{&recording, std::vector<Use>(recording.points.size(), use)};
  split.use[0] = Use::kNone;
  return split;
}

SplitRecording HoldOutFrames(const Recording& recording) {
  SplitRecording split = UseAll(recording, Use::kFit);
  const auto block = static_cast<std::size_t>(std::max(1.0, kHeldBlock * recording.fps));
  const auto future = static_cast<std::size_t>(recording.train_frames);
  const bool has_future = future < split.use.size();
  for (std::size_t frame = 1; frame < split.use.size(); ++frame) {
    const bool held = has_future ? frame >= future : frame / block % 4 == 3;
    if (held) split.use[frame] = Use::kHeld;
  }
  return split;
}

std::vector<SplitRecording> Shorten(std::vector<SplitRecording> recordings, double part) {
  for (SplitRecording& split : recordings) {
    const int frames = std::max(2, static_cast<int>(part * split.last(Use::kFit)));
    for (std::size_t frame = 0; frame < split.use.size(); ++frame) {
      const bool kept = static_cast<int>(frame) < frames && split.use[frame] == Use::kFit;
      if (!kept) split.use[frame] = Use::kNone;
    }
  }
  return recordings;
}

}  // namespace physpring
