// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/outliers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/plain_rope.h"

namespace physpring {
namespace {

using testing::HasSubstr;

std::vector<int> Range(int first, int last) {
  std::vector<int> range(last - first);
  std::iota(range.begin(), range.end(), first);
  return range;
}

TEST(Outliers, AreNoneInACleanRecording) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    PlainRope rope;
    rope.seed = seed;
    rope.fps = seed % 2 == 0 ? 30 : 60;
    EXPECT_TRUE(FindOutliers(rope.Record()).empty()) << seed;
  }
}

TEST(Outliers, AreAllFramesOfATrackAfterItJumpsForGood) {
  Recording recording = PlainRope().Record();
  for (int t = 40; t < 120; ++t) recording.points[t].col(6) += Eigen::Vector3d(0.3, 0.2, 0.1);
  const std::vector<OutlyingTrack> found = FindOutliers(recording);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].point, 6);
  EXPECT_EQ(found[0].frames, Range(40, 120));
  EXPECT_NEAR(found[0].jump, 0.374, 0.01);
}

// The offset is about the distance to the neighbours, which swing about the point for long.
TEST(Outliers, StayOutUntilTheyAreBack) {
  for (int point = 2; point < 11; ++point) {
    Recording recording = PlainRope().Record();
    for (int t = 30; t < 120; ++t) recording.points[t].col(point) += Eigen::Vector3d(0, 0.1, 0);
    const std::vector<OutlyingTrack> found = FindOutliers(recording);
    ASSERT_EQ(found.size(), 1u) << point;
    EXPECT_EQ(found[0].frames, Range(30, 120)) << point;
  }
}

// A free end that whips leaves the motion of its neighbours, not its distance to them.
TEST(Outliers, AreNoneAtAnEndThatWhips) {
  PlainRope rope;
  rope.fps = 20;
  rope.frames = 60;
  rope.hand = [](double t) { return Eigen::Vector3d(0.25 * std::sin(9 * t), 0, 0); };
  EXPECT_TRUE(FindOutliers(rope.Record()).empty());
}

TEST(Outliers, AreTheFramesOfSpikes) {
  Recording recording = PlainRope().Record();
  for (int t = 30; t < 36; ++t) recording.points[t].col(4) += Eigen::Vector3d(0.1, 0.2, 0.1);
  recording.points[60].col(8) += Eigen::Vector3d(0, 0, 0.2);
  const std::vector<OutlyingTrack> found = FindOutliers(recording);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].frames, Range(30, 36));
  EXPECT_EQ(found[1].frames, std::vector<int>{60});
}

TEST(Outliers, AreTwoTracksThatAreExchanged) {
  Recording recording = PlainRope().Record();
  for (int t = 50; t < 120; ++t) recording.points[t].col(3).swap(recording.points[t].col(7));
  const std::vector<OutlyingTrack> found = FindOutliers(recording);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].frames, Range(50, 120));
  EXPECT_EQ(found[1].frames, Range(50, 120));
}

TEST(Outliers, AreLeftOutWithALine) {
  Recording recording = PlainRope().Record();
  recording.points[60].col(8) += Eigen::Vector3d(0, 0, 0.2);
  EXPECT_THAT(LeaveOutOutliers("a.npz", &recording),
              HasSubstr("a.npz: 1 measurements that leave their neighbours are taken as not seen: "
                        "point 8 jumps by 0.197 m in frame 60"));
  EXPECT_TRUE(recording.points[60].col(8).array().isNaN().all());
  EXPECT_EQ(LeaveOutOutliers("a.npz", &recording), "");
}

}  // namespace
}  // namespace physpring
