// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/split_recording.h"

#include <algorithm>
#include <limits>

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

Recording OnlyFitFrames(const SplitRecording& split) {
  Recording part = *split.recording;
  for (std::size_t frame = 1; frame < split.use.size(); ++frame) {
    if (split.use[frame] == Use::kFit) continue;
    part.points[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return part;
}

}  // namespace physpring
