// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/bending_triples.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/forked_rod.h"

namespace physpring {
namespace {

// Nodes on a line, each joined to the next two: of all springs that leave a node, those to the same
// distance on either side belong together, wherever the line lies.
TEST(BendingTriples, OfALineAreAsFarOnEitherSide) {
  constexpr int kNodes = 12;
  const Eigen::Vector3d step(0.011, -0.007, 0.013);
  SpringMassSystem system;
  system.position.resize(3, kNodes);
  for (int i = 0; i < kNodes; ++i) system.position.col(i) = i * step;
  system.mass = Eigen::VectorXd::Ones(kNodes);
  std::set<std::array<int, 3>> expected;
  for (int reach : {1, 2}) {
    for (int i = 0; i + reach < kNodes; ++i) system.springs.push_back({i, i + reach});
    for (int i = reach; i + reach < kNodes; ++i) expected.insert({i - reach, i, i + reach});
  }
  std::set<std::array<int, 3>> found;
  for (const BendingTriple& triple : FindBendingTriples(system)) {
    found.insert({triple.a, triple.b, triple.c});
    EXPECT_NEAR(triple.length, (triple.b - triple.a) * step.norm(), 1e-12);
  }
  EXPECT_EQ(found, expected);
}

// At a joint each two branches keep their angle; elsewhere a rod is straight at rest.
TEST(BendingTriples, OfARodWithBranchesAreWhatIsNextToEachOther) {
  SpringMassSystem system;
  system.position = ForkedPlaces();
  system.position(2, 4) = 0.05;  // bent at node 4 in the reference configuration
  system.mass = Eigen::VectorXd::Ones(10);
  system.rod = RodOfEdges(kForkedEdges, system.position);
  std::set<std::set<int>> found;
  for (const BendingTriple& triple : FindBendingTriples(system)) {
    found.insert({triple.a, triple.b, triple.c});
    if (triple.b != 2) EXPECT_EQ(triple.rest, 0);
    const std::set<int> ends = {triple.a, triple.c};
    // |kappa| = 2 sin(turn / 2): straight on, by 60 or 120 degrees, or from one branch to the other
    if (ends == std::set{1, 3}) EXPECT_NEAR(triple.rest, 0, 1e-7);
    if (ends == std::set{1, 6}) EXPECT_NEAR(triple.rest, 2 * std::sin(M_PI / 6), 1e-12);
    if (ends == std::set{3, 8}) EXPECT_NEAR(triple.rest, 2 * std::sin(M_PI / 3), 1e-12);
    if (ends == std::set{6, 8}) EXPECT_NEAR(triple.rest, 2 * std::sin(M_PI / 6), 1e-12);
  }
  EXPECT_EQ(found, (std::set<std::set<int>>{{0, 1, 2},
                                            {1, 2, 3},
                                            {1, 2, 6},
                                            {1, 2, 8},
                                            {2, 3, 6},
                                            {2, 3, 8},
                                            {2, 6, 8},
                                            {2, 3, 4},
                                            {3, 4, 5},
                                            {2, 6, 7},
                                            {2, 8, 9}}));
}

// Controllers that hold throughout are part of the rod; of others it is free.
TEST(BendingTriples, OfARodLeaveOutControllersWithoutEdges) {
  SpringMassSystem system;
  system.position = Points::Zero(3, 4);
  system.position.row(0) << 0, 0.1, 0.2, 0.3;
  system.mass = Eigen::VectorXd::Ones(3);
  system.controllers = 1;
  system.rod = PlainRod(system.position.row(0));
  EXPECT_EQ(FindBendingTriples(system).size(), 2U);
  TakeOut(3, &system.rod);
  EXPECT_EQ(FindBendingTriples(system).size(), 1U);
}

}  // namespace
}  // namespace physpring
