// SPDX-License-Identifier: Apache-2.0
#include "tracker/live_tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tracker/tracked_body.h"
#include "twin/error.h"
#include "twin/local_motion.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

// Where the twin's nodes and controllers are when the first frame is measured: as it says, or where
// the points and the controllers that hold take them.
Points StartOf(const Twin& twin, const LiveFrame& first, const ControllerMask& held) {
  const SpringMassSystem& system = twin.levels[0].system;
  Points known = Points::Constant(3, system.position.cols(), std::nan(""));
  known.leftCols(first.measured.named.cols()) = first.measured.named;
  Points start = known;
  start.rightCols(system.controllers) = first.controllers;
  for (int c = 0; c < system.controllers; ++c) {
    if (held[c]) known.col(system.node_count() + c) = first.controllers.col(c);
  }
  const LocalMotion motion(system.position, known);
  for (int i = 0; i < start.cols(); ++i) {
    if (start.col(i).allFinite()) continue;
    const auto place = motion.Move(system.position.col(i));
    if (!place) {
      throw Error(
          "the first frame has no point and no controller that holds, so nobody knows where the "
          "object is");
    }
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
      held_(controllers_, true),
      holding_(HeldIn(first)),
      bank_(MakeBank(twin, options, first)) {
  held_ = holding_;
  lately_.fps = fps_;
}

TrackerBank LiveTracker::MakeBank(const Twin& twin, const LiveOptions& options,
                                  const LiveFrame& first) {
  const TrackedBody body = BodyToTrack(twin.levels[0].system, fps_, options.substeps);
  softened_ = body.softened;
  const Points start = StartOf(twin, first, holding_);
  lately_.controllers.emplace_back(start.rightCols(controllers_));
  const Points nodes = start.leftCols(start.cols() - controllers_);
  return TrackerBank(
      body.system, {twin.gravity, twin.ground.plane},
      {1 / fps_, body.substeps, twin.controller_velocity, ControllerMask(controllers_, true)},
      options.noise, twin.points, nodes, Points::Zero(3, nodes.cols()));
}

ControllerMask LiveTracker::HeldIn(const LiveFrame& frame) const {
  const auto points = frame.measured.named.cols();
  if (points != 0 && points != points_) {
    throw Error(fmt::format("has {} points, expected {}, or none", points, points_));
  }
  if (frame.controllers.cols() != controllers_) {
    throw Error(
        fmt::format("has {} controllers, expected {}", frame.controllers.cols(), controllers_));
  }
  const ControllerMask held = frame.held.value_or(held_);
  if (held.size() != held_.size()) {
    throw Error(fmt::format("says of {} controllers whether they hold, expected {}", held.size(),
                            controllers_));
  }
  for (int c = 0; c < controllers_; ++c) {
    if (held[c] && !frame.controllers.col(c).allFinite()) {
      throw Error(fmt::format("does not say where controller {} is, which holds", c));
    }
  }
  return held;
}

// A controller holds on the way to a frame if it does in the frame before, too (recorded_input.h).
void LiveTracker::SetGrasps(const ControllerMask& held, FrameInput* input) {
  ControllerMask holding(controllers_), released(controllers_), attached(controllers_);
  for (int c = 0; c < controllers_; ++c) {
    holding[c] = held_[c] && held[c];
    released[c] = !holding[c];
    attached[c] = holding[c] && !holding_[c];
  }
  const auto any = [](const ControllerMask& mask) {
    return std::find(mask.begin(), mask.end(), true) != mask.end();
  };
  if (any(released)) input->released = released;
  if (any(attached)) input->attached = {attached, *(lately_.controllers.end() - 2), Points()};
  held_ = held;
  holding_ = holding;
}

void LiveTracker::Advance(const LiveFrame& frame) {
  const ControllerMask held = HeldIn(frame);
  const Points places =
      frame.controllers.array().isFinite().select(frame.controllers, lately_.controllers.back());
  lately_.controllers.push_back(places);
  const auto needed = 3 + static_cast<std::size_t>(std::max(0.0, std::ceil(delay_ * fps_)));
  if (lately_.controllers.size() > needed) lately_.controllers.erase(lately_.controllers.begin());
  const int last = static_cast<int>(lately_.controllers.size()) - 1;
  FrameInput input = RecordedInput(lately_, last, delay_);
  input.time = frame_++ / fps_;
  SetGrasps(held, &input);
  bank_.Advance(input, frame.measured);
  if (!state().position().allFinite() || !state().velocity().allFinite())
    throw Error("the tracked motion diverges");
}

}  // namespace physpring
