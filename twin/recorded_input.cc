// SPDX-License-Identifier: Apache-2.0
#include "twin/recorded_input.h"

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

}  // namespace

FrameInput RecordedInput(const Recording& recording, int frame, double delay) {
  FrameInput input;
  input.time = (frame - 1) / recording.fps;
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
