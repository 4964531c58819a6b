// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/first_order_stage.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/phystwin_variables.h"
#include "trainer/journal/packing.h"

namespace physpring {
namespace {

constexpr RolloutOptions kOptions{.substeps = 120};

PhysTwinVariables Variables() {
  PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 1);
  variables.spring_y = 2000;
  return variables;
}

SpringMassSystem System(const Recording& recording) {
  return MakePhysTwinSystem(recording, Variables(), false);
}

// The motion of a rope with springs 20 % stiffer than System's.
Recording StifferRope(int frames) {
  Recording recording = SwungRope(8, frames);
  SpringMassSystem stiffer = System(recording);
  stiffer.stiffness *= 1.2;
  MoveAs(stiffer, true, &recording);
  return recording;
}

TEST(FirstOrderStage, StartsFromTheGivenSystem) {
  const SpringMassSystem system = System(SwungRope(8, 2));
  const FirstOrderStage stage(system, 10);
  EXPECT_LT((stage.Best().stiffness - system.stiffness).norm(), 1e-12 * system.stiffness.norm());
  EXPECT_EQ(stage.Best().contact.surface.friction, system.contact.surface.friction);
}

// 240 steps of 0.001 are enough for the logarithm of 1.2.
TEST(FirstOrderStage, LowersTheLoss) {
  const Recording recording = StifferRope(13);
  FirstOrderStage stage(System(recording), 21);
  stage.Pass({recording}, kOptions, 1);
  const double first = stage.last_loss();
  while (!stage.done()) stage.Pass({recording}, kOptions, 1);
  EXPECT_LT(stage.last_loss(), 0.2 * first);
  EXPECT_GT(stage.Best().stiffness.mean(), 1.05 * System(recording).stiffness.mean());
}

TEST(FirstOrderStage, StepsOnceAFrame) {
  const Recording recording = StifferRope(5);
  FirstOrderStage stage(System(recording), 10);
  stage.Pass({recording}, kOptions, 1);
  EXPECT_EQ(stage.steps(), 4);
  // a step of Adam is about as long as its rate, 0.001, where the gradient keeps its sign
  const Eigen::ArrayXd change =
      (stage.Current().stiffness.array() / System(recording).stiffness.array()).log();
  EXPECT_GT(change.abs().maxCoeff(), 2e-3);
  EXPECT_LT(change.abs().maxCoeff(), 4.4e-3);
}

TEST(FirstOrderStage, KeepsTheBestOfThePassesLookedAt) {
  const Recording recording = StifferRope(4);
  FirstOrderStage stage(System(recording), 23);
  stage.Pass({recording}, kOptions, 1);  // pass 0 is looked at
  const SpringMassSystem after_first = stage.Current();
  EXPECT_EQ(stage.Best().stiffness, after_first.stiffness);
  for (int i = 1; i < 20; ++i) stage.Pass({recording}, kOptions, 1);
  EXPECT_EQ(stage.Best().stiffness, after_first.stiffness);  // 1 to 19 are not
  stage.Pass({recording}, kOptions, 1);
  EXPECT_EQ(stage.Best().stiffness, stage.Current().stiffness);
  EXPECT_EQ(stage.best_loss(), stage.last_loss());
}

TEST(FirstOrderStage, LeavesAParameterBeyondItsClampWhereItIs) {
  const Recording recording = StifferRope(4);
  SpringMassSystem system = System(recording);
  const double at_limit = kPhysTwinLargestY * system.mass[0] / system.rest_length[0];
  system.stiffness[0] = 2 * at_limit;
  FirstOrderStage stage(system, 10);
  stage.Pass({recording}, {.substeps = 600}, 1);
  ASSERT_FALSE(stage.diverged());
  EXPECT_DOUBLE_EQ(stage.Current().stiffness[0], at_limit);
  EXPECT_DOUBLE_EQ(stage.values()[0], std::log(2 * kPhysTwinLargestY));
}

TEST(FirstOrderStage, WalksAlongRecordingsOfDifferentLength) {
  const Recording one = StifferRope(8);
  Recording other = StifferRope(4);
  FirstOrderStage stage(System(one), 3);
  stage.Pass({one, other, one}, kOptions, 1);
  EXPECT_EQ(stage.steps(), 7);
}

TEST(FirstOrderStage, GivesTheSameBitsForAnyNumberOfThreads) {
  const std::vector<Recording> recordings = {StifferRope(6), StifferRope(3), StifferRope(5)};
  FirstOrderStage one(System(recordings[0]), 5), three(one);
  for (int i = 0; i < 3; ++i) {
    one.Pass(recordings, kOptions, 1);
    three.Pass(recordings, kOptions, 3);
  }
  EXPECT_EQ(Pack(one), Pack(three));
}

TEST(FirstOrderStage, EndsWhenAPassDiverges) {
  const Recording recording = StifferRope(6);
  SpringMassSystem system = System(recording);
  FirstOrderStage stage(system, 10);
  stage.Pass({recording}, {.substeps = 1}, 1);
  EXPECT_TRUE(stage.diverged());
  EXPECT_TRUE(stage.done());
  EXPECT_LT((stage.Best().stiffness - system.stiffness).norm(), 1e-12 * system.stiffness.norm());
}

}  // namespace
}  // namespace physpring
