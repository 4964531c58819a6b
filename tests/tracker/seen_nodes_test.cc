// SPDX-License-Identifier: Apache-2.0
#include "tracker/seen_nodes.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

constexpr double kFrame = 0.02;  // s

Eigen::VectorXd Counts(double first, double second) {
  Eigen::VectorXd count = Eigen::VectorXd::Constant(10, second);
  count.head(5).setConstant(first);
  return count;
}

TEST(SeenNodes, AreAllSeenWhereCloudsShowAll) {
  SeenNodes seen(10, 10);
  EXPECT_EQ(seen.weight(), Eigen::VectorXd::Ones(10));
  for (int t = 0; t < 100; ++t) seen.Learn(Counts(0.4, 0.4), kFrame);
  EXPECT_TRUE(seen.weight().isOnes(1e-9));
}

TEST(SeenNodes, ForgetThoseThatNothingBelongsToButNotForGood) {
  SeenNodes seen(10, 10);
  for (int t = 0; t < 100; ++t) seen.Learn(Counts(3, 0.01), kFrame);
  EXPECT_TRUE(seen.weight().head(5).isOnes(1e-2));
  EXPECT_LT(seen.weight().tail(5).maxCoeff(), 0.2);
  EXPECT_GT(seen.weight().tail(5).minCoeff(), 0.05);
  for (int t = 0; t < 50; ++t) seen.Learn(Counts(0.01, 3), kFrame);
  EXPECT_TRUE(seen.weight().tail(5).isOnes(1e-2));
}

TEST(SeenNodes, LearnNothingFromAnEmptyCloud) {
  SeenNodes seen(10, 10);
  seen.Learn(Counts(1, 0), kFrame);
  const Eigen::VectorXd before = seen.weight();
  for (int t = 0; t < 100; ++t) seen.Learn(Counts(0, 0), kFrame);
  EXPECT_EQ(seen.weight(), before);
}

TEST(SeenNodes, FindNodesInsideThatCloudsShowAllTheSame) {
  SeenNodes seen(10, 5);
  EXPECT_TRUE(seen.weight().head(5).isOnes());
  EXPECT_LT(seen.weight().tail(5).maxCoeff(), 0.2);
  for (int t = 0; t < 300; ++t) seen.Learn(Counts(0.4, 0.4), kFrame);
  EXPECT_TRUE(seen.weight().isOnes(1e-2));
}

// A frame is as much as the time that it stands for.
TEST(SeenNodes, FadeWithTime) {
  SeenNodes often(10, 10), seldom(10, 10);
  for (int t = 0; t < 20; ++t) often.Learn(Counts(1, 0), kFrame);
  for (int t = 0; t < 4; ++t) seldom.Learn(Counts(1, 0), 5 * kFrame);
  EXPECT_TRUE(often.weight().isApprox(seldom.weight(), 1e-9));
}

}  // namespace
}  // namespace physpring
