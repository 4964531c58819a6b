// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
constexpr int kPoints = 6, kUnseenPoint = 2;

// Two frames of 6 points, one of them not seen in frame 1, with 9 unlabelled surface points.
Recording TwoFrames() {
  Random random(2);
  Recording recording;
  for (int frame = 0; frame < 2; ++frame) {
    recording.points.push_back(random.Box(kPoints, 0.1));
    recording.surface.push_back(random.Box(9, 0.1));
  }
  recording.points[1].col(kUnseenPoint).setConstant(kUnseen);
  recording.surface[1].col(4).setConstant(kUnseen);
  return recording;
}

// Of the points and two interior particles.
Points RandomPositions() { return Random(3).Box(kPoints + 2, 0.1); }

double FrameLoss(const Points& position, const Recording& recording, const LossOptions& options) {
  Points bar = Points::Zero(3, position.cols());
  return AddFrameLoss(position, recording, 1, options, &bar);
}

class FrameLossDerivative : public testing::TestWithParam<LossOptions> {};

TEST_P(FrameLossDerivative, AgreesWithDifferences) {
  Recording recording = TwoFrames();
  recording.weight.assign(2, Eigen::MatrixXd::Constant(1, kPoints, 0.5));
  recording.weight[1](0, 1) = 3;
  Points position = RandomPositions();
  Points bar = Points::Zero(3, position.cols());
  AddFrameLoss(position, recording, 1, GetParam(), &bar);
  ASSERT_GT(bar.norm(), 0);
  std::vector<CheckedVariable> variables;
  for (int i = 0; i < position.cols(); ++i) {
    for (int j = 0; j < 3; ++j) {
      variables.push_back(
          {std::to_string(i) + "," + std::to_string(j), &position(j, i), 1e-4, bar(j, i)});
    }
  }
  const auto loss = [&] {
    return static_cast<long double>(FrameLoss(position, recording, GetParam()));
  };
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
}

// Both sides of the smooth L1's beta, and each term alone.
INSTANTIATE_TEST_SUITE_P(Options, FrameLossDerivative,
                         testing::Values(LossOptions{}, LossOptions{1, 0, 0.05},
                                         LossOptions{0, 1, 1}, LossOptions{3, 2, 0.02}));

TEST(FrameLoss, AddsToTheDerivative) {
  const Recording recording = TwoFrames();
  const Points position = RandomPositions();
  Points once = Points::Zero(3, position.cols());
  AddFrameLoss(position, recording, 1, {}, &once);
  Points twice = once;
  AddFrameLoss(position, recording, 1, {}, &twice);
  EXPECT_LT((twice - 2 * once).norm(), 1e-15);
}

TEST(FrameLoss, UnseenPointsAreIgnored) {
  const Recording recording = TwoFrames();
  const LossOptions track_only{1, 0, 1};
  Points position = RandomPositions();
  Points bar = Points::Zero(3, position.cols());
  const double before = AddFrameLoss(position, recording, 1, track_only, &bar);
  EXPECT_EQ(bar.col(kUnseenPoint).norm(), 0);
  EXPECT_GT(bar.col(kUnseenPoint + 1).norm(), 0);
  position.col(kUnseenPoint).setConstant(5);
  EXPECT_EQ(FrameLoss(position, recording, track_only), before);
}

// 5 points are seen: one is 0.2 off along x (quadratic), one 0.8 along y (linear, beta = 0.5).
TEST(FrameLoss, TrackTermHasTheStatedValue) {
  const Recording recording = TwoFrames();
  Points position = recording.points[1];
  position.col(kUnseenPoint).setZero();
  position(0, 0) += 0.2;
  position(1, 5) -= 0.8;
  EXPECT_NEAR(FrameLoss(position, recording, {3, 0, 0.5}), 3.0 / 15 * (0.04 + 0.8 - 0.25), 1e-12);
}

TEST(FrameLoss, WeightsAreFactorsOfThePointsTerms) {
  Recording recording = TwoFrames();
  const Points position = RandomPositions();
  const LossOptions options{.chamfer_weight = 0};
  const double even = FrameLoss(position, recording, options);
  recording.weight.assign(2, Eigen::MatrixXd::Constant(1, kPoints, 2));
  EXPECT_NEAR(FrameLoss(position, recording, options), 2 * even, 1e-12);
}

TEST(FrameLoss, ChamferTermHasTheStatedValue) {
  Recording recording;
  recording.points.assign(2, Points::Zero(3, 2));
  recording.points[1].col(1).setConstant(1);
  Points position = recording.points[1];
  position(2, 1) += 0.1;
  EXPECT_NEAR(FrameLoss(position, recording, {0, 4, 1}), 4.0 / 2 * 0.01, 1e-12);  // of the points
  recording.surface.assign(2, Points::Zero(3, 1));
  recording.surface[1](0, 0) = 0.3;
  EXPECT_NEAR(FrameLoss(position, recording, {0, 4, 1}), 4.0 * 0.09, 1e-12);
}

TEST(FrameLoss, FrameInWhichNothingWasSeenHasNone) {
  Recording recording = TwoFrames();
  recording.points[1].setConstant(kUnseen);
  recording.surface[1].setConstant(kUnseen);
  const Points position = RandomPositions();
  Points bar = Points::Zero(3, position.cols());
  EXPECT_EQ(AddFrameLoss(position, recording, 1, {}, &bar), 0);
  EXPECT_EQ(bar.norm(), 0);
}

}  // namespace
}  // namespace physpring
