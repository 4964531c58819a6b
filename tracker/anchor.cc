// SPDX-License-Identifier: Apache-2.0
#include "tracker/anchor.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "tracker/track_recording.h"
#include "twin/error.h"
#include "twin/grasps.h"

namespace physpring {
namespace {

// The frames [first, end) of what has all frames of the recording, or none.
template <class Frame>
void Keep(int first, int end, std::vector<Frame>* frames) {
  if (frames->empty()) return;
  *frames = std::vector<Frame>(frames->begin() + first, frames->begin() + end);
}

Recording Part(Recording recording, int first, int end) {
  Keep(first, end, &recording.points);
  Keep(first, end, &recording.weight);
  Keep(first, end, &recording.controllers);
  Keep(first, end, &recording.force);
  Keep(first, end, &recording.surface);
  Keep(first, end, &recording.track);
  recording.hash.clear();
  recording.train_frames = std::min(recording.train_frames, end - first);
  return recording;
}

}  // namespace

Recording AnchoredAt(int frame, const Twin& twin, const Recording& recording) {
  const int frames = recording.frame_count(), particles = recording.particle_count();
  if (frame < 1 || frame + 2 > frames - 1) {
    throw Error(fmt::format("recording {}: cannot begin in frame {}, expected 1 to {}",
                            recording.name, frame, frames - 3));
  }
  if (HasChangingGrasps(recording)) {
    throw Error(fmt::format(
        "recording {}: has grasps that begin or end ('held'), so it cannot begin in frame {}",
        recording.name, frame));
  }
  const TrackedMotion motion = TrackRecording(twin, Part(recording, 0, frame + 1), {});
  Recording anchored = Part(recording, frame, frames);
  anchored.held.resize(0, 0);
  anchored.start.leftCols(particles) = motion.position.back();
  anchored.start.rightCols(recording.controller_count()) = anchored.controllers[0];
  anchored.velocity = motion.velocity.back();
  return anchored;
}

}  // namespace physpring
