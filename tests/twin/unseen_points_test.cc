// SPDX-License-Identifier: Apache-2.0
#include "twin/unseen_points.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

namespace physpring {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// 3 x 3 x 2 points 2 cm apart.
Points MakeBlock() {
  Points points(3, 18);
  for (int i = 0; i < 18; ++i) {
    points.col(i) = 0.02 * Eigen::Vector3i(i % 3, i / 3 % 3, i / 9).cast<double>();
  }
  return points;
}

// The block in two frames, in the second one turned by `angle` and moved, with point 4 not seen in
// the first frame.
Recording MakeRecording(double angle) {
  const Eigen::AngleAxisd turn(angle, Eigen::Vector3d(1, 2, 3).normalized());
  Recording recording;
  recording.points = {MakeBlock(), turn.toRotationMatrix() * MakeBlock()};
  recording.points[1].colwise() += Eigen::Vector3d(0.1, 0, -0.3);
  recording.controllers.assign(2, Points(3, 0));
  recording.interior.resize(3, 0);
  recording.points[0].col(4).setConstant(kNan);
  recording.start = recording.points[0];
  return recording;
}

TEST(UnseenPoints, MoveBackWithTheirNeighboursFromTheFirstFrameThatSeesThem) {
  for (const double angle : {0.0, 0.5, 1.5}) {
    Recording recording = MakeRecording(angle);
    EXPECT_EQ(PlaceUnseenPoints(recording), std::vector<int>{4});
    // the rotation is regularised: 1e-5 of the 2 cm to the neighbours
    EXPECT_LT((recording.start.col(4) - MakeBlock().col(4)).norm(), 1e-6) << angle;
  }
}

TEST(UnseenPoints, MoveWithTheirNeighboursFromTheStressFreeShape) {
  Recording recording = MakeRecording(0);
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d::UnitX());
  recording.rest = turn.toRotationMatrix() * MakeBlock();
  recording.rest_given = true;
  recording.points[1].col(4).setConstant(kNan);  // the frames would not help
  PlaceUnseenPoints(recording);
  EXPECT_LT((recording.start.col(4) - MakeBlock().col(4)).norm(), 1e-6);
}

TEST(UnseenPoints, LeaveOthersAsTheyAre) {
  Recording recording = MakeRecording(0.5);
  const Points before = recording.start;
  PlaceUnseenPoints(recording);
  EXPECT_EQ(recording.start.leftCols(4), before.leftCols(4));
  EXPECT_EQ(recording.start.rightCols(13), before.rightCols(13));
}

// One neighbour tells a displacement, no rotation.
TEST(UnseenPoints, ShiftWithASingleNeighbour) {
  Recording recording;
  recording.points = {Points::Constant(3, 1, kNan), Points::Constant(3, 1, 5)};
  recording.controllers = {Points::Constant(3, 1, 1), Points::Constant(3, 1, 3)};
  recording.interior.resize(3, 0);
  recording.start.resize(3, 2);
  recording.start << recording.points[0], recording.controllers[0];
  PlaceUnseenPoints(recording);
  EXPECT_EQ(recording.start.col(0), Eigen::Vector3d::Constant(3));
}

TEST(UnseenPoints, StayWhereFirstSeenWithoutNeighbours) {
  Recording recording;
  recording.points = {Points::Constant(3, 2, kNan), Points::Constant(3, 2, kNan),
                      Points::Random(3, 2)};
  recording.controllers.assign(3, Points(3, 0));
  recording.interior.resize(3, 0);
  recording.start = recording.points[0];
  EXPECT_EQ(PlaceUnseenPoints(recording), (std::vector<int>{0, 1}));
  EXPECT_EQ(recording.start, recording.points[2]);
}

}  // namespace
}  // namespace physpring
