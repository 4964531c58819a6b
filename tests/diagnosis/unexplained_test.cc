// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/unexplained.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace physpring {
namespace {

// Three nodes, ten steps, and forces on node 1 alone.
ResidualPattern OnNode1(const Points& force) {
  ResidualPattern pattern;
  pattern.root_mean_square = force.norm();
  pattern.node.resize(3, 3);
  pattern.node << 0, 1, 2, 0, 0, 0, 0, 0, 5;
  pattern.node_force = Eigen::Vector3d(0, force.norm() / std::sqrt(10.0), 0);
  pattern.net = force;
  for (Eigen::Index t = 0; t < force.cols(); ++t) pattern.over_time.push_back(force.col(t).norm());
  return pattern;
}

TEST(Unexplained, IsWhereAndWhenTheMissingForceIsLargest) {
  Points force = Points::Zero(3, 10);
  force.row(0).setConstant(0.1);
  for (int t : {4, 5, 6}) force.col(t) = Eigen::Vector3d(0, 0, -2);
  const Unexplained left = FindUnexplained(OnNode1(force), 0.003, 20);
  EXPECT_TRUE(left.located);
  EXPECT_EQ(left.track, 0.003);
  EXPECT_EQ(left.particle, 1);
  EXPECT_EQ(left.position, Eigen::Vector3d(1, 0, 0));
  EXPECT_DOUBLE_EQ(left.first_time, 0.2);  // two of the three large ones hold half
  EXPECT_DOUBLE_EQ(left.last_time, 0.3);
  EXPECT_NEAR((left.direction - Eigen::Vector3d(0, 0, -1)).norm(), 0, 1e-12);
  EXPECT_NEAR(left.steadiness, 1, 1e-12);
}

TEST(Unexplained, SaysThatADirectionTurns) {
  Points force = Points::Zero(3, 10);
  for (int t = 0; t < 10; ++t) {
    const double angle = 2 * std::numbers::pi * t / 5;
    force.col(t) = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  const Unexplained left = FindUnexplained(OnNode1(force), 0.003, 10);
  EXPECT_DOUBLE_EQ(left.last_time - left.first_time, 0.5);  // a turn
  EXPECT_NEAR(left.steadiness, 0, 1e-12);
}

TEST(Unexplained, IsNowhereWithoutForces) {
  const Unexplained left = FindUnexplained(OnNode1(Points::Zero(3, 10)), 0.003, 10);
  EXPECT_FALSE(left.located);
  EXPECT_EQ(left.track, 0.003);
}

}  // namespace
}  // namespace physpring
