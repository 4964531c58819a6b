// SPDX-License-Identifier: Apache-2.0
#include "tracker/soft_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace physpring {
namespace {

Points Row(int count) {
  Points row = Points::Zero(3, count);
  for (int i = 0; i < count; ++i) row(0, i) = 0.1 * i;
  return row;
}

TEST(SoftMatch, GivesPointsToTheNodesThatTheyAreAt) {
  const Points nodes = Row(5);
  const SoftMatch match = MatchSoftly(nodes, Eigen::VectorXd::Ones(5), nodes, 0.01, 0.05);
  EXPECT_TRUE(match.target.isApprox(nodes, 1e-9));
  for (double count : match.count) EXPECT_NEAR(count, 1 / 1.05, 1e-9);
}

TEST(SoftMatch, SharesAPointThatIsBetweenTwo) {
  Points cloud(3, 1);
  cloud << 0.05, 0, 0;
  const SoftMatch match = MatchSoftly(Row(2), Eigen::VectorXd::Ones(2), cloud, 0.05, 0);
  EXPECT_NEAR(match.count[0], 0.5, 1e-12);
  EXPECT_NEAR(match.count[1], 0.5, 1e-12);
  EXPECT_TRUE(match.target.col(0).isApprox(cloud.col(0)));
}

TEST(SoftMatch, GivesMoreToNodesOfMoreWeight) {
  Points cloud(3, 1);
  cloud << 0.05, 0, 0;
  const SoftMatch match = MatchSoftly(Row(2), Eigen::Vector2d(1, 0.25), cloud, 0.05, 0);
  EXPECT_NEAR(match.count[0], 0.8, 1e-12);
  EXPECT_NEAR(match.count[1], 0.2, 1e-12);
}

TEST(SoftMatch, GivesAHalfToNoneWhereTheyAreAsLikely) {
  constexpr double kWidth = 0.02, kNone = 0.05;
  Points cloud(3, 1);
  cloud << 0, kWidth * std::sqrt(-2 * std::log(kNone)), 0;
  EXPECT_NEAR(MatchSoftly(Row(1), Eigen::VectorXd::Ones(1), cloud, kWidth, kNone).count[0], 0.5,
              1e-12);
}

TEST(SoftMatch, LeavesNodesWithoutPointsWhereTheyAre) {
  Points cloud = Points::Constant(3, 2, std::numeric_limits<double>::quiet_NaN());
  cloud.col(0) << 7, 7, 7;  // far from all
  const Points nodes = Row(3);
  const SoftMatch match = MatchSoftly(nodes, Eigen::VectorXd::Ones(3), cloud, 0.01, 0.05);
  EXPECT_TRUE(match.count.isZero(0));
  EXPECT_EQ(match.target, nodes);
}

}  // namespace
}  // namespace physpring
