// SPDX-License-Identifier: Apache-2.0
#include "twin/free_twin.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/error.h"

namespace physpring {
namespace {

TEST(WithoutControllers, KeepsTheSpringsBetweenNodesInTheirOrder) {
  const Twin held = SmallTwin(2), free = WithoutControllers(held);
  for (int level = 0; level < 2; ++level) {
    const SpringMassSystem& before = held.levels[level].system;
    const SpringMassSystem& after = free.levels[level].system;
    int kept = 0;
    for (int e = 0; e < before.spring_count(); ++e) {
      const auto& [a, b] = before.springs[e];
      if (std::max(a, b) >= before.node_count()) continue;
      ASSERT_LT(kept, after.spring_count());
      EXPECT_EQ(after.springs[kept], before.springs[e]);
      EXPECT_EQ(after.rest_length[kept], before.rest_length[e]);
      ++kept;
    }
    EXPECT_EQ(after.spring_count(), kept);
    EXPECT_LT(kept, before.spring_count());
    EXPECT_EQ(after.controllers, 0);
    EXPECT_EQ(after.node_count(), before.node_count());
  }
}

TEST(WithoutControllers, GivesATwinThatCanBeStored) {
  const TemporaryFolder folder;
  WriteTwin(WithoutControllers(SmallTwin(3)), folder.File("free.twin.npz"));
  EXPECT_EQ(ReadTwin(folder.File("free.twin.npz")).levels.size(), 3u);
}

TEST(WithoutControllers, RefusesATwinThatOnlyControllersHoldTogether) {
  Twin twin = SmallTwin(1);
  SpringMassSystem& system = twin.levels[0].system;
  system.springs = {{0, system.node_count()}};
  system.stiffness = system.rest_length = system.dashpot = Eigen::VectorXd::Ones(1);
  EXPECT_THROW(WithoutControllers(twin), Error);
}

}  // namespace
}  // namespace physpring
