// SPDX-License-Identifier: Apache-2.0
#include "tracker/anchor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_twin.h"
#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 24, kAnchor = 14;

class AnchorTest : public testing::Test {
 protected:
  AnchorTest() : recording_(RecordingOfMotion(twin_, kFrames)) {
    // it is pushed, which the twin does not know
    for (int t = 0; t < kFrames; ++t)
      recording_.points[t].row(1).array() += 0.001 * std::min(t, 10);
  }

  // Mean distance of the points after the anchor.
  static double ErrorOf(const Points& predicted, const Points& measured) {
    return (predicted.leftCols(measured.cols()) - measured).colwise().norm().mean();
  }

  const Twin twin_ = SmallTwin(1);
  Recording recording_;
};

TEST_F(AnchorTest, BeginsWhereTheObjectIs) {
  const Recording anchored = AnchoredAt(kAnchor, twin_, recording_);
  ASSERT_EQ(anchored.frame_count(), kFrames - kAnchor);
  EXPECT_EQ(anchored.points[1], recording_.points[kAnchor + 1]);
  EXPECT_EQ(anchored.controllers[2], recording_.controllers[kAnchor + 2]);
  EXPECT_EQ(anchored.start.rightCols(2), recording_.controllers[kAnchor]);
  const double blind =
      ErrorOf(Predict(twin_, 0, recording_, {})[kAnchor + 1], recording_.points[kAnchor + 1]);
  const double anew = ErrorOf(Predict(twin_, 0, anchored, {})[1], recording_.points[kAnchor + 1]);
  EXPECT_GT(blind, 4e-3);
  EXPECT_LT(anew, 0.5 * blind);
}

TEST_F(AnchorTest, SeesNoLaterFrame) {
  const Recording anchored = AnchoredAt(kAnchor, twin_, recording_);
  for (int t = kAnchor + 1; t < kFrames; ++t) recording_.points[t].array() += 0.1;
  const Recording again = AnchoredAt(kAnchor, twin_, recording_);
  EXPECT_EQ(again.start, anchored.start);
  EXPECT_EQ(again.velocity, anchored.velocity);
}

TEST_F(AnchorTest, RefusesFramesThatLeaveNothing) {
  const auto message = [&](int frame) -> std::string {
    try {
      AnchoredAt(frame, twin_, recording_);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(kFrames - 2), HasSubstr("cannot begin in frame 22, expected 1 to 21"));
  EXPECT_THAT(message(0), HasSubstr("cannot begin in frame 0"));
  EXPECT_EQ(message(kFrames - 3), "");
  recording_.held.resize(kFrames, 2);
  recording_.held.setConstant(true);
  recording_.held(4, 1) = false;
  EXPECT_THAT(message(kAnchor), HasSubstr("has grasps that begin or end"));
}

}  // namespace
}  // namespace physpring
