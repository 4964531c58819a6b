// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_classes.h"

#include <gtest/gtest.h>

#include "tests/support/simulation.h"

namespace physpring {
namespace {

// Springs of these lengths between nodes, and from two controllers to nodes.
SpringMassSystem Star(const std::vector<double>& lengths,
                      const std::vector<std::pair<int, double>>& hands) {
  const int nodes = static_cast<int>(lengths.size()) + 1;
  SpringMassSystem system = Particles(Points::Zero(3, nodes + 2), 0.01);
  system.controllers = 2;
  system.mass.conservativeResize(nodes);
  system.contact_radius.conservativeResize(nodes);
  for (int i = 1; i < nodes; ++i) AddSpring(0, i, 10, lengths[i - 1], 0.1, &system);
  int end = 0;
  for (const auto& [controller, length] : hands) {
    AddSpring(end++, nodes + controller, 10, length, 0.1, &system);
  }
  return system;
}

TEST(SpringClasses, EndWhereLengthsJump) {
  const SpringClasses classes =
      ClassesOf(Star({0.02, 0.01, 0.0101, 0.03}, {}), {.jump = 1.05, .hands_apart = true});
  EXPECT_EQ(classes.of_spring, (std::vector<int>{1, 0, 0, 2}));
  EXPECT_EQ(classes.count, 3);
  EXPECT_EQ(classes.lengths, 3);
  EXPECT_FALSE(classes.irregular);
}

TEST(SpringClasses, AreEquallyFilledWhereLengthsDoNotJump) {
  std::vector<double> lengths(12);
  for (int i = 0; i < 12; ++i) lengths[i] = 0.01 * std::pow(1.04, i);
  const SpringClasses classes =
      ClassesOf(Star(lengths, {}), {.jump = 1.05, .equal = 4, .hands_apart = true});
  EXPECT_TRUE(classes.irregular);
  EXPECT_EQ(classes.of_spring, (std::vector<int>{0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3}));
}

TEST(SpringClasses, LongSpringsOfAnIrregularMeshMayBeInFinerOnes) {
  std::vector<double> lengths(16);
  for (int i = 0; i < 16; ++i) lengths[i] = 0.01 * std::pow(1.04, i);
  const SpringClasses classes =
      ClassesOf(Star(lengths, {}), {.jump = 1.05, .equal = 2, .finer = {lengths[6], 4}});
  EXPECT_EQ(classes.of_spring, (std::vector<int>{0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3}));
  EXPECT_EQ(classes.count, 4);
  EXPECT_EQ(classes.like_the_last, std::vector<bool>(4, true));
}

// A square of nodes with a diagonal, whose springs have these lengths: along x twice, along y
// twice, and the diagonal.
SpringMassSystem Square(const std::vector<double>& lengths) {
  Points corners = Points::Zero(3, 4);
  corners << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  SpringMassSystem system = Particles(corners, 0.01);
  const std::vector<std::pair<int, int>> ends = {{0, 1}, {3, 2}, {0, 2}, {3, 1}, {0, 3}};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    AddSpring(ends[i].first, ends[i].second, 10, lengths[i], 0.1, &system);
  }
  return system;
}

TEST(SpringClasses, MayTellDirectionsOfOneLengthApart) {
  SpringClassOptions options{1.05, 6};
  const SpringMassSystem square = Square({1, 1, 1, 1, 1.4});
  EXPECT_EQ(ClassesOf(square, options).of_spring, (std::vector<int>{0, 0, 0, 0, 1}));
  EXPECT_EQ(ClassesOf(square, options).like_the_last, (std::vector<bool>{false, false}));
  options.directions = true;
  const SpringClasses apart = ClassesOf(square, options);
  EXPECT_EQ(apart.of_spring, (std::vector<int>{0, 0, 1, 1, 2}));
  EXPECT_EQ(apart.like_the_last, (std::vector<bool>{false, true, false}));
  EXPECT_EQ(apart.lengths, 3);
  EXPECT_EQ(apart.count, 3);
}

TEST(SpringClasses, DirectionsOfAnIrregularMeshAreNotToldApart) {
  const SpringMassSystem square = Square({1, 1.049, 1.1, 1.153, 1.21});
  SpringClassOptions options{1.05, 2};
  const std::vector<int> by_length = ClassesOf(square, options).of_spring;
  options.directions = true;
  const SpringClasses classes = ClassesOf(square, options);
  EXPECT_TRUE(classes.irregular);
  EXPECT_EQ(classes.of_spring, by_length);
  EXPECT_EQ(classes.like_the_last, (std::vector<bool>{true, true}));
}

TEST(SpringClasses, HandsAreClassedByHowNearTheyAre) {
  const SpringMassSystem star =
      Star({0.01, 0.02, 0.02}, {{0, 0.03}, {1, 0.05}, {0, 0.01}, {1, 0.04}});
  const SpringClasses apart = ClassesOf(star, {.jump = 1.05, .hands_apart = true});
  EXPECT_EQ(apart.of_spring, (std::vector<int>{0, 1, 1, 3, 3, 2, 2}));
  EXPECT_EQ(apart.lengths, 2);
  EXPECT_EQ(apart.count, 4);
  const SpringClasses together = ClassesOf(star, {1.05, 6, false});
  EXPECT_EQ(together.of_spring, (std::vector<int>{0, 1, 1, 2, 4, 0, 3}));
  EXPECT_EQ(together.lengths, together.count);
}

}  // namespace
}  // namespace physpring
