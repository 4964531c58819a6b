// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/start_velocity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/support/plain_rope.h"

namespace physpring {
namespace {

TEST(StartVelocity, OfARopeThatSwingsIsTrue) {
  PlainRope rope;
  rope.before = 1;
  const std::optional<StartVelocity> found = EstimateStartVelocity(rope.Record());
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->measured);
  rope.noise = 0;
  rope.fps = 6000;  // so fast that a difference is the velocity
  rope.frames = 3;
  const Recording exact = rope.Record();
  const Points truth = (exact.points[2] - exact.points[0]) * rope.fps / 2;
  const double speed = truth.colwise().norm().mean();
  EXPECT_GT(speed, 0.2);
  EXPECT_LT((found->velocity - truth).colwise().norm().mean(), 0.2 * speed) << "noise makes 0.15";
}

TEST(StartVelocity, OfAThrownBlockIsTrue) {
  Recording block;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 5e-4);
  const Eigen::Vector3d v(1.5, 0.4, 3), turn(2, 3, 1);
  Points shape(3, 27);
  for (int i = 0; i < 27; ++i) {
    const int row = i / 3 % 3, layer = i / 9;
    shape.col(i) << 0.04 * (i % 3), 0.04 * row, 0.04 * layer;
  }
  shape.colwise() -= shape.rowwise().mean().eval();
  for (int t = 0; t < 45; ++t) {
    const double s = t / 60.0;
    const Eigen::Vector3d centre = v * s + Eigen::Vector3d(0, 0, 1 - 0.5 * 9.81 * s * s);
    const Eigen::Matrix3d r = Eigen::AngleAxisd(turn.norm() * s, turn.normalized()).matrix();
    block.points.emplace_back(
        ((r * shape).colwise() + centre).unaryExpr([&](double x) { return x + noise(random); }));
    block.controllers.emplace_back(3, 0);
  }
  block.fps = 60;
  block.train_frames = 31;
  block.start = block.points[0];
  block.interior.resize(3, 0);
  const std::optional<StartVelocity> found = EstimateStartVelocity(block);
  ASSERT_TRUE(found.has_value());
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3d truth = v + turn.cross(shape.col(i));
    EXPECT_LT((found->velocity.col(i) - truth).norm(), 0.06) << i;
  }
}

TEST(StartVelocity, OfAStartFromRestIsNone) {
  PlainRope rope;
  EXPECT_FALSE(EstimateStartVelocity(rope.Record()).has_value()) << "slack, the hand moves at once";
  rope.before = 8;
  rope.hand = [](double t) {
    return Eigen::Vector3d(t < 0 ? 0 : 0.1 * (1 - std::cos(5 * t)), 0, 0);
  };
  EXPECT_FALSE(EstimateStartVelocity(rope.Record()).has_value()) << "hangs at rest";
  rope.hand = [](double) { return Eigen::Vector3d(0, 0, 0); };
  EXPECT_FALSE(EstimateStartVelocity(rope.Record()).has_value()) << "never moves";
  rope.noise = 0;
  Recording still = rope.Record();
  for (Points& frame : still.points) frame = still.points[0];
  EXPECT_FALSE(EstimateStartVelocity(still).has_value()) << "nothing but rounding";
}

// A taut body that falls from rest: it vibrates with about the time of two frames.
TEST(StartVelocity, OfAVibrationFromRestIsNone) {
  Recording taut = PlainRope().Record();
  for (int t = 0; t < taut.frame_count(); ++t) {
    const double fallen = 0.02 * (1 - std::cos(0.9 * M_PI * t) * std::exp(-0.1 * t));
    taut.points[t] =
        taut.start.leftCols(taut.point_count()).colwise() - Eigen::Vector3d(0, 0, fallen);
  }
  EXPECT_FALSE(EstimateStartVelocity(taut).has_value());
}

// Most of the body is far from the only point that is seen.
TEST(StartVelocity, OfABodyThatIsHardlyMeasuredIsNotKnown) {
  PlainRope rope;
  rope.before = 1;
  Recording recording = rope.Record();
  recording.interior = recording.start.leftCols(11);
  for (Points& frame : recording.points) frame = frame.rightCols(2).eval();
  Points start(3, 2 + 11 + 1);
  start << recording.points[0], recording.interior, recording.controllers[0];
  recording.start = start;
  const std::optional<StartVelocity> found = EstimateStartVelocity(recording);
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->measured);
}

// It is let go, and falls into its stiff springs in two frames. That looks like a steady velocity.
TEST(StartVelocity, OfAStiffBodyThatIsLetGoIsNone) {
  const std::vector<double> fallen = {0, 2.4e-3, 5.4e-3, 5.7e-3, 4.9e-3, 5.1e-3, 7.6e-3};  // m
  Recording recording;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 6e-4);
  for (std::size_t t = 0; t < 60; ++t) {
    Points points(3, 60);
    for (int i = 0; i < 60; ++i) {
      const int row = i / 6;
      points.col(i) << 0.03 * (i % 6) + noise(random), 0.03 * row + noise(random),
          1 - fallen[std::min(t, fallen.size() - 1)] + noise(random);
    }
    recording.points.push_back(points);
    recording.controllers.emplace_back(Points::Zero(3, 1));
  }
  recording.fps = 40;
  recording.train_frames = recording.frame_count();
  recording.start.resize(3, 61);
  recording.start << recording.points[0], recording.controllers[0];
  EXPECT_FALSE(EstimateStartVelocity(recording).has_value());
  for (Points& hand : recording.controllers) hand(0, 0) += 1e-3;  // now the hands move, too
  recording.controllers[0].setZero();
  EXPECT_TRUE(EstimateStartVelocity(recording).has_value());
}

}  // namespace
}  // namespace physpring
