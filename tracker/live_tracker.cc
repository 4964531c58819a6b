// SPDX-License-Identifier: Apache-2.0
#include "tracker/live_tracker.h"

#include <fmt/format.h>

#include <cmath>

#include "tracker/tracked_body.h"
#include "twin/error.h"
#include "twin/local_motion.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

// Where the twin's nodes are when the first frame is measured.
Points StartOf(const Twin& twin, const LiveFrame& first) {
  const SpringMassSystem& system = twin.levels[0].system;
  Points known = Points::Constant(3, system.position.cols(), std::nan(""));
  known.leftCols(first.measured.named.cols()) = first.measured.named;
  known.rightCols(system.controllers) = first.controllers;
  const LocalMotion motion(system.position, known);
  Points start = known.leftCols(system.node_count());
  for (int i = 0; i < start.cols(); ++i) {
    if (start.col(i).allFinite()) continue;
    const auto place = motion.Move(system.position.col(i));
    if (!place)
      throw Error(
          "the first frame has no point and no controller, so nobody knows where "
          "the object is");
    start.col(i) = *place;
  }
  return start;
}

}  // namespace

LiveTracker::LiveTracker(const Twin& twin, const LiveOptions& options, const LiveFrame& first)
    : points_(twin.points),
      controllers_(twin.levels[0].system.controllers),
      fps_(options.fps),
      delay_(ControllerDelay(twin.levels[0].system)),
      bank_(MakeBank(twin, options, first)) {
  lately_.fps = fps_;
  lately_.controllers.push_back(first.controllers);
}

TrackerBank LiveTracker::MakeBank(const Twin& twin, const LiveOptions& options,
                                  const LiveFrame& first) const {
  ExpectNumbers(first);
  const TrackedBody body = BodyToTrack(twin.levels[0].system, fps_, options.substeps);
  const Points start = StartOf(twin, first);
  return TrackerBank(body.system, {twin.gravity, twin.ground.plane},
                     {1 / fps_, body.substeps, twin.controller_velocity, {}}, options.noise,
                     twin.points, start, Points::Zero(3, start.cols()));
}

void LiveTracker::ExpectNumbers(const LiveFrame& frame) const {
  const auto points = frame.measured.named.cols();
  if (points != 0 && points != points_) {
    throw Error(fmt::format("has {} points, expected {}, or none", points, points_));
  }
  if (frame.controllers.cols() != controllers_) {
    throw Error(
        fmt::format("has {} controllers, expected {}", frame.controllers.cols(), controllers_));
  }
}

void LiveTracker::Advance(const LiveFrame& frame) {
  ExpectNumbers(frame);
  lately_.controllers.push_back(frame.controllers);
  const auto needed = 3 + static_cast<std::size_t>(std::max(0.0, std::ceil(delay_ * fps_)));
  if (lately_.controllers.size() > needed) lately_.controllers.erase(lately_.controllers.begin());
  const int last = static_cast<int>(lately_.controllers.size()) - 1;
  FrameInput input = RecordedInput(lately_, last, delay_);
  input.time = frame_++ / fps_;
  bank_.Advance(input, frame.measured);
  if (!state().position().allFinite() || !state().velocity().allFinite())
    throw Error("the tracked motion diverges");
}

}  // namespace physpring
