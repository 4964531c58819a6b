// SPDX-License-Identifier: Apache-2.0
#include "twin/recorded_input.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace physpring {
namespace {

constexpr double kFps = 50;
constexpr int kFrames = 6;

// A controller whose x is the square of the frame.
Recording Accelerated() {
  Recording recording;
  recording.fps = kFps;
  for (int t = 0; t < kFrames; ++t)
    recording.controllers.emplace_back(Eigen::Vector3d(t * t, 1, 2));
  return recording;
}

// The square, linear between frames and constant beyond the ends.
double Expected(double frame) {
  const double at = std::clamp(frame, 0.0, kFrames - 1.0);
  const int from = std::min(static_cast<int>(at), kFrames - 2);
  return from * from + (at - from) * (2 * from + 1);
}

TEST(RecordedInput, IsLaterOrEarlierByTheDelay) {
  const Recording recording = Accelerated();
  for (const double delay : {0.0, 0.013, 0.05, 0.3, -0.013, -0.05, -0.3}) {
    for (int frame = 1; frame < kFrames; ++frame) {
      const FrameInput input = RecordedInput(recording, frame, delay);
      EXPECT_NEAR(input.controllers_start(0, 0), Expected(frame - 1 - kFps * delay), 1e-12);
      EXPECT_NEAR(input.controllers_end(0, 0), Expected(frame - kFps * delay), 1e-12);
      EXPECT_EQ(input.controllers_end.col(0).tail(2), Eigen::Vector2d(1, 2));
    }
  }
}

TEST(RecordedInput, KnowsHowItChangesWithTheDelay) {
  const Recording recording = Accelerated();
  const double h = 1e-4;
  for (const double delay : {0.013, 0.033, -0.013, -0.033, -0.3}) {
    for (int frame = 1; frame < kFrames; ++frame) {
      const FrameInput input = RecordedInput(recording, frame, delay),
                       more = RecordedInput(recording, frame, delay + h),
                       less = RecordedInput(recording, frame, delay - h);
      EXPECT_NEAR(input.delay_rate_start(0, 0),
                  (more.controllers_start - less.controllers_start)(0, 0) / (2 * h), 1e-7);
      EXPECT_NEAR(input.delay_rate_end(0, 0),
                  (more.controllers_end - less.controllers_end)(0, 0) / (2 * h), 1e-7);
    }
  }
}

}  // namespace
}  // namespace physpring
