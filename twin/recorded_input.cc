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

void PlaceBeforeAdjoint(const Recording& recording, int frame, double delay, const Points& bar,
                        std::vector<Points>* controllers_bar) {
  const double place = frame - delay;
  const int next = static_cast<int>(std::ceil(place));
  if (next <= 0) {
    controllers_bar->front() += bar;
  } else if (next >= static_cast<int>(recording.controllers.size())) {
    controllers_bar->back() += bar;
  } else {
    const double back = next - place;
    (*controllers_bar)[static_cast<std::size_t>(next) - 1] += back * bar;
    (*controllers_bar)[static_cast<std::size_t>(next)] += (1 - back) * bar;
  }
}

// Whether a controller holds on the way from frame - 1 to `frame`.
bool Holds(const Recording& recording, int frame, Eigen::Index controller) {
  return recording.held(frame - 1, controller) && recording.held(frame, controller);
}

// The controllers of which that is so; empty if it is so of none.
template <class Function>
ControllerMask Which(const Recording& recording, Function is_so) {
  ControllerMask mask;
  for (Eigen::Index c = 0; c < recording.held.cols(); ++c) mask.push_back(is_so(c));
  return std::find(mask.begin(), mask.end(), true) == mask.end() ? ControllerMask{} : mask;
}

ControllerMask ReleasedIn(const Recording& recording, int frame) {
  return Which(recording, [&](Eigen::Index c) { return !Holds(recording, frame, c); });
}

Attachment AttachedIn(const Recording& recording, int frame) {
  const auto shape = recording.shape_when_held.find(frame - 1);
  if (frame == 1 || shape == recording.shape_when_held.end()) return {};
  return {Which(recording,
                [&](Eigen::Index c) {
                  return Holds(recording, frame, c) && !Holds(recording, frame - 1, c);
                }),
          recording.controllers[static_cast<std::size_t>(frame) - 1], shape->second};
}

}  // namespace

ControllerMask LateGraspsOf(const Recording& recording) {
  return Which(recording, [&](Eigen::Index c) { return !Holds(recording, 1, c); });
}

FrameInput RecordedInput(const Recording& recording, int frame, double delay) {
  FrameInput input;
  input.time = (frame - 1) / recording.fps;
  input.released = ReleasedIn(recording, frame);
  input.attached = AttachedIn(recording, frame);
  if (recording.controllers.empty()) {
    input.controllers_start = input.controllers_end = Points(3, 0);
    return input;
  }
  const double frames = delay * recording.fps;
  input.controllers_start = PlaceBefore(recording, frame - 1, frames, &input.delay_rate_start);
  input.controllers_end = PlaceBefore(recording, frame, frames, &input.delay_rate_end);
  return input;
}

void RecordedInputAdjoint(const Recording& recording, int frame, double delay,
                          const Points& start_bar, const Points& end_bar,
                          std::vector<Points>* controllers_bar) {
  if (recording.controllers.empty()) return;
  const double frames = delay * recording.fps;
  PlaceBeforeAdjoint(recording, frame - 1, frames, start_bar, controllers_bar);
  PlaceBeforeAdjoint(recording, frame, frames, end_bar, controllers_bar);
}

}  // namespace physpring
