// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/frame_times.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/plain_rope.h"
#include "twin/checks/plausibility.h"

namespace physpring {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kEvery = 10, kOdd = 7;  // of every ten frames the seventh is odd

// The rope, with the frames that `times` gives for each of its own: 0 leaves one out.
Recording With(int times, const PlainRope& rope = {}) {
  const Recording whole = rope.Record();
  Recording recording = whole;
  recording.points.clear();
  recording.controllers.clear();
  for (int t = 0; t < whole.frame_count(); ++t) {
    for (int n = 0; n < (t % kEvery == kOdd ? times : 1); ++n) {
      recording.points.push_back(whole.points[t]);
      recording.controllers.push_back(whole.controllers[t]);
    }
  }
  return recording;
}

TEST(FrameTimes, SaysNothingOfASmoothMotion) {
  EXPECT_EQ(OddFrameTimes(PlainRope().Record()), "");
  EXPECT_EQ(OddFrameTimes(HangingRope(5e-3).Record()), "");
  EXPECT_EQ(OddFrameTimes(TwoRopes()), "");
}

TEST(FrameTimes, NamesTheFramesAfterThoseThatAreMissing) {
  const Recording recording = With(0);
  const std::vector<int> gaps = FramesAfterGaps(recording);
  for (int frame : gaps) EXPECT_EQ(frame % (kEvery - 1), kOdd) << frame;
  EXPECT_GE(gaps.size(), 6U);  // of 11
  EXPECT_THAT(FindOddities(recording), ElementsAre(AllOf(HasSubstr("missing before frames 7, "),
                                                         HasSubstr("were some dropped?"))));
}

TEST(FrameTimes, NamesFramesThatAreThereTwice) {
  const Recording recording = With(2);
  EXPECT_THAT(RepeatedFrames(recording), testing::SizeIs(12));
  EXPECT_THAT(FindOddities(recording),
              ElementsAre(HasSubstr("frames 8, 19, 30, 41, 52, 63, 74, 85, ... (12 in all) are "
                                    "exactly those before them")));
}

TEST(FrameTimes, NamesFramesThatAreThereSeveralTimes) {
  const Recording recording = With(3);
  EXPECT_THAT(RepeatedFrames(recording), testing::SizeIs(24));
  EXPECT_THAT(OddFrameTimes(recording), HasSubstr("recorded twice"));
}

TEST(FrameTimes, TakesAShakyHandForNoGap) {
  PlainRope rope;
  rope.hand = [](double t) {  // shakes at a third of the rate of frames
    return Eigen::Vector3d(0.1 * std::sin(5 * t) + 0.004 * std::sin(125 * t), 0, 0);
  };
  EXPECT_THAT(FramesAfterGaps(rope.Record()), IsEmpty());
}

TEST(FrameTimes, TakesRestForNoRepetition) {
  Recording recording = PlainRope().Record();
  for (int t = 60; t < 120; ++t) {
    recording.points[t] = recording.points[60];
    recording.controllers[t] = recording.controllers[60];
  }
  EXPECT_EQ(OddFrameTimes(recording), "");
}

}  // namespace
}  // namespace physpring
