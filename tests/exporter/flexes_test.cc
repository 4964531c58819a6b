// SPDX-License-Identifier: Apache-2.0
#include "exporter/flexes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/random_system.h"
#include "tests/support/simulation.h"

namespace physpring {
namespace {

// A chain of 1 m steps with a spring for each stiffness.
SpringMassSystem Chain(const std::vector<double>& stiffness) {
  Points position = Points::Zero(3, static_cast<Eigen::Index>(stiffness.size()) + 1);
  for (Eigen::Index i = 0; i < position.cols(); ++i) position(0, i) = static_cast<double>(i);
  SpringMassSystem system = Particles(position, 1);
  for (std::size_t e = 0; e < stiffness.size(); ++e) {
    const int a = static_cast<int>(e);
    AddSpring(a, a + 1, stiffness[e], 1, 0.1, &system);
  }
  return system;
}

TEST(Flexes, GroupSpringsOfLikeStiffness) {
  const FlexGroups flexes = GroupSprings(Chain({10, 1000, 11, 990, 10.5, 1010}), 2);
  ASSERT_EQ(flexes.groups.size(), 2u);
  EXPECT_EQ(flexes.groups[0].springs, std::vector<int>({0, 2, 4}));
  EXPECT_EQ(flexes.groups[1].springs, std::vector<int>({1, 3, 5}));
  EXPECT_NEAR(flexes.groups[0].stiffness, std::cbrt(10 * 11 * 10.5), 1e-12);
}

TEST(Flexes, TellWhatIsLost) {
  SpringMassSystem system = Chain({10, 40});
  system.dashpot << 0.1, 0.4;
  system.rest_length << 1, 0.9;
  const FlexRounding rounding = GroupSprings(system, 1).rounding;
  // both springs get sqrt(10 * 40) N/m and 0.25 N s/m
  EXPECT_NEAR(rounding.stiffness_max, 1, 1e-12);
  EXPECT_NEAR(rounding.stiffness_mean, 0.75, 1e-12);
  EXPECT_NEAR(rounding.dashpot_mean, 0.15, 1e-12);
  EXPECT_NEAR(rounding.dashpot_max, 0.15, 1e-12);
  EXPECT_NEAR(rounding.rest_length_max, 0.1, 1e-12);
}

TEST(Flexes, LoseNothingWithAGroupForEachStiffness) {
  const FlexRounding rounding = GroupSprings(Chain({10, 20, 10, 20, 30}), 3).rounding;
  EXPECT_NEAR(rounding.stiffness_max, 0, 1e-12);
  EXPECT_EQ(rounding.rest_length_max, 0);
}

TEST(Flexes, LoseLessTheMoreThereAre) {
  const SpringMassSystem system = RandomSystem(200, 0, 3);
  double before = 1;
  for (const int count : {1, 4, 16}) {
    const FlexGroups flexes = GroupSprings(system, count);
    EXPECT_LE(flexes.groups.size(), static_cast<std::size_t>(count));
    EXPECT_LT(flexes.rounding.stiffness_mean, 0.5 * before);
    before = flexes.rounding.stiffness_mean;
  }
}

TEST(Flexes, LeaveTheSpringsOfControllersToTendons) {
  const SpringMassSystem system = RandomSystem(30, 2, 5);
  const FlexGroups flexes = GroupSprings(system, 4);
  std::set<int> held;
  for (const FlexGroup& group : flexes.groups)
    held.insert(group.springs.begin(), group.springs.end());
  EXPECT_EQ(held.size() + flexes.tendons.size(), system.springs.size());
  EXPECT_FALSE(flexes.tendons.empty());
  for (const int e : flexes.tendons) EXPECT_GE(system.springs[e][1], 30);
}

TEST(Flexes, SpringsWithoutStiffnessAreTheSoftest) {
  const FlexGroups flexes = GroupSprings(Chain({0, 100, 0}), 2);
  ASSERT_EQ(flexes.groups.size(), 2u);
  EXPECT_LT(flexes.groups[0].stiffness, 1e-6);
  EXPECT_NEAR(flexes.rounding.stiffness_max, 0, 1e-12);
}

}  // namespace
}  // namespace physpring
