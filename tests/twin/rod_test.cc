// SPDX-License-Identifier: Apache-2.0
#include "twin/rod.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/forked_rod.h"

namespace physpring {
namespace {

Eigen::VectorXd Lengths(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(), std::ssize(values));
}

TEST(Rod, ByArcLengthsIsAChain) {
  const Rod rod = PlainRod(Lengths({0.2, 0, 0.3, 0.1}));
  EXPECT_EQ(rod.edges, (RodEdges{{0, 2}, {0, 3}, {1, 3}}));
  EXPECT_TRUE(IsPlain(rod));
  EXPECT_EQ(RodJoints(rod), 0);
  EXPECT_DOUBLE_EQ(RodLength(rod), 0.3);
  EXPECT_EQ(RodWays(rod), (std::vector<std::vector<int>>{{1, 3, 0, 2}}));
}

TEST(Rod, OfEdgesWithoutJointsIsTheSameChain) {
  Points places = Points::Zero(3, 4);
  places.row(1) << 0.2, 0, 0.3, 0.1;
  const Rod rod = RodOfEdges({{3, 1}, {0, 3}, {2, 0}}, places);
  EXPECT_TRUE(IsPlain(rod));
  EXPECT_TRUE(rod.arc.isApprox(Lengths({0.2, 0, 0.3, 0.1})) ||
              rod.arc.isApprox(Lengths({0.1, 0.3, 0, 0.2})));
}

TEST(Rod, WithBranchesIsAsLongAsAllOfThem) {
  const Rod rod = ForkedRod();
  EXPECT_FALSE(IsPlain(rod));
  EXPECT_EQ(RodJoints(rod), 1);
  EXPECT_NEAR(RodLength(rod), 0.9, 1e-12);
  EXPECT_EQ(RodNeighbours(rod)[2].size(), 4U);
  std::vector<std::size_t> ways;
  for (const std::vector<int>& way : RodWays(rod)) ways.push_back(way.size());
  std::sort(ways.begin(), ways.end());
  EXPECT_EQ(ways, (std::vector<std::size_t>{3, 3, 3, 4}));
}

TEST(RodLengths, AreAlongTheRodBetweenJoints) {
  Points places = ForkedPlaces();
  places(2, 4) = 0.05;  // it is bent at rest, so that its end is nearer
  const Rod rod = RodOfEdges(kForkedEdges, places);
  const RodLengths lengths(rod);
  const auto apart = [&](int a, int b) { return (places.col(a) - places.col(b)).norm(); };
  EXPECT_TRUE(lengths.Along(3, 5));
  EXPECT_NEAR(lengths.Between(3, 5, places), apart(3, 4) + apart(4, 5), 1e-12);
  EXPECT_GT(lengths.Between(3, 5, places), 1.05 * apart(3, 5));
  for (const auto& [a, b] : {std::array{1, 6}, {6, 8}, {2, 7}, {0, 3}}) {
    EXPECT_FALSE(lengths.Along(a, b)) << a << " " << b;
    EXPECT_EQ(lengths.Between(a, b, places), apart(a, b));
  }
}

TEST(RodLengths, InALoopAreDistances) {
  Points ring(3, 6);
  for (int i = 0; i < 6; ++i) ring.col(i) << std::cos(i * M_PI / 3), std::sin(i * M_PI / 3), 0;
  const Rod rod = RodOfEdges({{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {0, 5}}, ring);
  const RodLengths lengths(rod);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(lengths.Between(i, (i + 1) % 6, ring), 1, 1e-12);
  EXPECT_EQ(RodJoints(rod), 0);
  EXPECT_EQ(RodWays(rod).size(), 1U);
  EXPECT_EQ(RodWays(rod)[0].size(), 7U);  // back to where it begins
}

TEST(Rod, JoinsWhatWasNextToOneThatIsTakenOut) {
  Rod rod = PlainRod(Lengths({0, 0.1, 0.2, 0.3}));
  TakeOut(1, &rod);
  EXPECT_EQ(rod.edges, (RodEdges{{0, 2}, {2, 3}}));
  TakeOut(3, &rod);
  EXPECT_EQ(rod.edges, (RodEdges{{0, 2}}));
  EXPECT_TRUE(IsPlain(rod));
  EXPECT_EQ(RodOfNodes(PlainRod(Lengths({0, 0.2, 0.4, 0.1})), 3).edges, (RodEdges{{0, 1}, {1, 2}}));
}

TEST(Rod, APartHasTheEdgesWithin) {
  const Rod part = PartOfRod(ForkedRod(), {7, 6, 2, 1});
  EXPECT_EQ(part.edges, (RodEdges{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(part.arc[0], ForkedRod().arc[7]);
}

TEST(Rod, ColumnsWithoutEdgesAreWhereTheNearestIs) {
  Points places(3, 11);
  places << ForkedPlaces(), Eigen::Vector3d(0.5, 0, 0.2);
  const Rod rod = RodOfEdges(kForkedEdges, places);
  EXPECT_EQ(rod.arc[10], rod.arc[5]);
  EXPECT_EQ(RodParts(rod)[10], -1);
  EXPECT_FALSE(RodLengths(rod).Along(10, 5));
}

TEST(CoarseRod, JoinsNodesWhoseMembersAreJoined) {
  // pairs along the rod; node 1 is around the joint
  const Rod coarse = CoarseRod(ForkedRod(), {0, 0, 1, 1, 2, 2, 3, 3, 4, 4}, 5);
  EXPECT_EQ(coarse.edges, (RodEdges{{0, 1}, {1, 2}, {1, 3}, {1, 4}}));
  EXPECT_EQ(coarse.arc[0], (ForkedRod().arc[0] + ForkedRod().arc[1]) / 2);
}

// Members of the nodes of a plain rod lie between each other, and the last column is a controller.
TEST(CoarseRod, OfAPlainRodIsPlain) {
  const Rod coarse = CoarseRod(PlainRod(Lengths({0, 0.1, 0.2, 0.3, 0.4})), {0, 1, 0, 1}, 2);
  EXPECT_EQ(coarse.edges, (RodEdges{{0, 1}, {1, 2}}));
  EXPECT_TRUE(coarse.arc.isApprox(Lengths({0.1, 0.2, 0.4})));
}

}  // namespace
}  // namespace physpring
