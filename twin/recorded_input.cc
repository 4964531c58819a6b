// SPDX-License-Identifier: Apache-2.0
#include "twin/recorded_input.h"

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

// Where the controllers are `delay` frames before `frame`, or after it if negative; sets how fast
// that changes with a delay in seconds (at a frame: with a longer delay).
Points PlaceBefore(const Recording& recording, int frame, double delay, Points* rate) {
  const double place = frame - delay;
  const int next = static_cast<int>(std::ceil(place));
  if (next <= 0) {
    *rate = Points::Zero(3, recording.controller_count());
    return recording.controllers[0];
  }
  if (next >= static_cast<int>(recording.controllers.size())) {
    *rate = Points::Zero(3, recording.controller_count());
    return recording.controllers.back();
  }
  const Points &from = recording.controllers[next - 1], &to = recording.controllers[next];
  *rate = (from - to) * recording.fps;
  const double back = next - place;
  return back == 0 ? to : Points(to + back * (from - to));
}

Released ReleasedIn(const Recording& recording, int frame) {
  Released released;
  if (recording.held.size() == 0) return released;
  bool any = false;
  for (int c = 0; c < recording.held.cols(); ++c) {
    released.push_back(!(recording.held(frame - 1, c) && recording.held(frame, c)));
    any = any || released.back();
  }
  return any ? released : Released{};
}

}  // namespace

std::vector<Released> ReleasesOf(const Recording& recording) {
  std::vector<Released> releases;
  for (int frame = 1; frame < recording.frame_count(); ++frame) {
    const Released released = ReleasedIn(recording, frame);
    const bool is_new = std::find(releases.begin(), releases.end(), released) == releases.end();
    if (!released.empty() && is_new) releases.push_back(released);
  }
  return releases;
}

FrameInput RecordedInput(const Recording& recording, int frame, double delay) {
  FrameInput input;
  input.time = (frame - 1) / recording.fps;
  input.released = ReleasedIn(recording, frame);
  if (recording.controllers.empty()) {
    input.controllers_start = input.controllers_end = Points(3, 0);
    return input;
  }
  const double frames = delay * recording.fps;
  input.controllers_start = PlaceBefore(recording, frame - 1, frames, &input.delay_rate_start);
  input.controllers_end = PlaceBefore(recording, frame, frames, &input.delay_rate_end);
  return input;
}

}  // namespace physpring
