// SPDX-License-Identifier: Apache-2.0
#include "report/picture/view.h"

#include <gtest/gtest.h>

#include "report/picture/nice_step.h"

namespace physpring {
namespace {

// Points at random in a box of half that size, one frame.
Recording Box(const Eigen::Vector3d& half_size) {
  Recording recording;
  recording.points.emplace_back(half_size.asDiagonal() * Points::Random(3, 500));
  return recording;
}

TEST(View, LaysTheGreatestHorizontalSpreadAcross) {
  // the long side of the box stands 45 degrees to the axes
  Recording recording = Box({1, 0.1, 0.5});
  const Eigen::Matrix3d turn =
      (Eigen::Matrix3d() << M_SQRT1_2, -M_SQRT1_2, 0, M_SQRT1_2, M_SQRT1_2, 0, 0, 0, 1).finished();
  recording.points[0] = (turn * recording.points[0]).eval();
  const View view(recording);
  const Points axis = view.ToUpright((Points(3, 2) << 0, M_SQRT1_2, 0, M_SQRT1_2, 0, 0).finished());
  const Eigen::Vector3d direction = axis.col(1) - axis.col(0);
  EXPECT_GT(direction.x(), 0.99);
  EXPECT_NEAR(direction.z(), 0, 1e-12);
}

TEST(View, HasGravityDown) {
  Recording recording = Box({1, 0.5, 0.2});
  recording.gravity = {0, 9.81, 0};
  const View view(recording);
  const Points fall = view.ToUpright((Points(3, 2) << 0, 0, 0, 1, 0, 0).finished());
  EXPECT_NEAR(fall(2, 1) - fall(2, 0), -1, 1e-12);
}

TEST(View, LooksDownOnFlatBodies) {
  EXPECT_GT(View(Box({1, 1, 0.01})).elevation(), 0.6);
  EXPECT_LT(View(Box({1, 0.01, 1})).elevation(), 0.5);
}

TEST(View, KeepsDistances) {
  const Recording recording = Box({1, 0.5, 0.2});
  const Points upright = View(recording).ToUpright(recording.points[0]);
  EXPECT_NEAR((upright.col(3) - upright.col(8)).norm(),
              (recording.points[0].col(3) - recording.points[0].col(8)).norm(), 1e-12);
}

TEST(View, BoundsWhatWasMeasured) {
  Recording recording = Box({1, 0.5, 0.2});
  recording.points.emplace_back(Points::Constant(3, 1, std::nan("")));  // not seen
  const View view(recording);
  const Points upright = view.ToUpright(recording.points[0]);
  EXPECT_LT((upright.rowwise().minCoeff() - view.low()).norm(), 1e-12);
  EXPECT_LT((upright.rowwise().maxCoeff() - view.high()).norm(), 1e-12);
}

TEST(GroundGrid, LiesOnTheGround) {
  Recording recording = Box({1, 0.5, 0.2});
  EXPECT_EQ(GroundGrid(recording, View(recording)).cols(), 0);
  recording.ground = Eigen::Vector4d(0, 0, 1, -0.3);
  const View view(recording);
  const Points grid = GroundGrid(recording, view);
  const double height = view.ToUpright(Eigen::Vector3d(0, 0, -0.3))(2, 0);
  ASSERT_GT(grid.cols(), 8);
  EXPECT_LT((grid.row(2).array() - height).abs().maxCoeff(), 1e-12);
}

TEST(NiceStep, IsOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(NiceStep(0.03), 0.05);
  EXPECT_DOUBLE_EQ(NiceStep(0.05), 0.05);
  EXPECT_DOUBLE_EQ(NiceStep(0.051), 0.1);
  EXPECT_DOUBLE_EQ(NiceStep(120), 200);
}

}  // namespace
}  // namespace physpring
