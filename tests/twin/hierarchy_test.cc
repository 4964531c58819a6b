// SPDX-License-Identifier: Apache-2.0
#include "twin/hierarchy.h"

#include <gtest/gtest.h>

#include "tests/support/small_twin.h"
#include "twin/error.h"

namespace physpring {
namespace {

TEST(NodesOfParticles, FollowTheAssignmentsOneAfterTheOther) {
  const Twin twin = SmallTwin(3);
  const std::vector<int> nodes = NodesOfParticles(twin, 2);
  ASSERT_EQ(nodes.size(), 40u);
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(nodes[i], twin.levels[2].assignment[twin.levels[1].assignment[i]]);
    EXPECT_EQ(NodesOfParticles(twin, 0)[i], i);
  }
}

TEST(SurfaceNodes, AreThoseWithAPointInThem) {
  Twin twin = SmallTwin(2);
  twin.points = 3;  // in nodes 0, 1, 2 of level 1; all others are interior
  twin.interior = 37;
  EXPECT_EQ(SurfaceNodes(twin, 0), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(SurfaceNodes(twin, 1), (std::vector<int>{0, 1, 2}));
  twin.levels[1].assignment[1] = 0;
  EXPECT_EQ(SurfaceNodes(twin, 1), (std::vector<int>{0, 2}));
}

TEST(AverageOverMembers, KeepsMomentum) {
  const Twin twin = SmallTwin(3);
  const Points velocity = Points::Random(3, 40);
  const Eigen::Vector3d momentum = velocity * twin.levels[0].system.mass;
  for (int level : {0, 1, 2}) {
    const Points means = AverageOverMembers(twin, level, velocity);
    EXPECT_LT((means * twin.levels[level].system.mass - momentum).norm(), 1e-15);
  }
}

TEST(LevelOf, RefusesALevelThatIsNotThere) {
  const Twin twin = SmallTwin(1);
  EXPECT_THROW(LevelOf(twin, 1), Error);
  EXPECT_THROW(LevelOf(twin, -1), Error);
}

}  // namespace
}  // namespace physpring
