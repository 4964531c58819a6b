// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/phystwin_variables.h"

#include <gtest/gtest.h>

#include "tests/support/small_twin.h"
#include "tests/support/swung_rope.h"
#include "trainer/motion/rollout.h"

namespace physpring {
namespace {

Eigen::VectorXd Corner(double value) {
  return Eigen::VectorXd::Constant(kPhysTwinVariables, value);
}

// The figures of the published configuration.
TEST(PhysTwinVariables, StartFromThePublishedParameters) {
  const PhysTwinVariables start = FromUnitCube(PhysTwinStart(), 1);
  EXPECT_DOUBLE_EQ(start.spring_y, 3e4);
  EXPECT_DOUBLE_EQ(start.object_radius, 0.02);
  EXPECT_EQ(start.object_neighbours, 30);
  EXPECT_DOUBLE_EQ(start.controller_radius, 0.04);
  EXPECT_EQ(start.controller_neighbours, 50);
  EXPECT_DOUBLE_EQ(start.restitution, 0.5);
  EXPECT_DOUBLE_EQ(start.friction, 0.3);
  EXPECT_DOUBLE_EQ(start.object_restitution, 0.7);
  EXPECT_DOUBLE_EQ(start.object_friction, 0.3);
  EXPECT_DOUBLE_EQ(start.collision_distance, 0.02);
  EXPECT_DOUBLE_EQ(start.drag, 3);
  EXPECT_DOUBLE_EQ(start.dashpot, 100);
}

TEST(PhysTwinVariables, SpanThePublishedRanges) {
  const PhysTwinVariables least = FromUnitCube(Corner(0), 1), most = FromUnitCube(Corner(1), 1);
  EXPECT_EQ(least.spring_y, 0);
  EXPECT_EQ(most.spring_y, 1e5);
  EXPECT_DOUBLE_EQ(most.object_radius, 0.05);
  EXPECT_EQ(least.object_neighbours, 10);
  EXPECT_EQ(most.controller_neighbours, 80);
  EXPECT_EQ(most.friction, 2);
  EXPECT_EQ(most.dashpot, 200);
}

TEST(PhysTwinVariables, ScaleLengthsOnly) {
  const PhysTwinVariables plain = FromUnitCube(Corner(0.5), 1);
  const PhysTwinVariables scaled = FromUnitCube(Corner(0.5), 3);
  EXPECT_DOUBLE_EQ(scaled.object_radius, 3 * plain.object_radius);
  EXPECT_DOUBLE_EQ(scaled.controller_radius, 3 * plain.controller_radius);
  EXPECT_DOUBLE_EQ(scaled.collision_distance, 3 * plain.collision_distance);
  EXPECT_EQ(scaled.spring_y, plain.spring_y);
  EXPECT_EQ(scaled.object_neighbours, plain.object_neighbours);
}

TEST(PhysTwinVariables, WidenRadiiForWideSpacingButNeverNarrowThem) {
  Recording block = RecordingOfMotion(SmallTwin(1), 2);  // 20 mm apart
  EXPECT_NEAR(PhysTwinLengthScale(block), 4, 1e-12);
  block.rest *= 0.1;
  EXPECT_EQ(PhysTwinLengthScale(block), 1);
}

// Nodes of 1 kg with Y and the dashpot as they are move as true masses with the converted ones.
TEST(PhysTwinVariables, GiveTrueMassesTheMotionOfOneKilogram) {
  Recording recording = SwungRope(8, 6);
  PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 2);
  variables.spring_y = 3000;
  const SpringMassSystem converted = MakePhysTwinSystem(recording, variables, false);
  EXPECT_NEAR(converted.mass.sum(), recording.mass, 1e-15);

  SpringMassSystem published = converted;
  published.mass.setOnes();
  published.dashpot.setConstant(variables.dashpot);
  for (int e = 0; e < published.spring_count(); ++e) {
    const auto [a, b] = published.springs[e];
    const double rest = (recording.rest.col(a) - recording.rest.col(b)).norm();
    published.stiffness[e] = variables.spring_y / rest;
  }
  const RolloutOptions options{.controller_velocity = false, .substeps = 300};
  const auto ours = RollOut(converted, {&recording, 6}, options);
  const auto theirs = RollOut(published, {&recording, 6}, options);
  ASSERT_FALSE(ours->diverged());
  EXPECT_GT((ours->positions()[5] - ours->positions()[0]).norm(), 0.01);
  // rounding, 1500 sub-steps
  EXPECT_LT((ours->positions()[5] - theirs->positions()[5]).norm(), 1e-12);
}

TEST(PhysTwinVariables, SearchSpringsWithinTheRadii) {
  const Recording recording = RecordingOfMotion(SmallTwin(1), 2);  // a cubic grid of 20 mm
  PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 1);
  variables.object_radius = 0.021;
  variables.controller_radius = 0.025;
  const SpringMassSystem system = MakePhysTwinSystem(recording, variables, false);
  // edges of a 5 x 4 x 2 grid, and the 4 particles under each of 2 controllers, 24.5 mm away
  EXPECT_EQ(system.spring_count(), 4 * 4 * 2 + 5 * 3 * 2 + 5 * 4 + 2 * 4);
}

TEST(PhysTwinVariables, CountTheParticleItselfAsANeighbour) {
  const Recording recording = SwungRope(30, 2);
  PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 1);
  variables.object_radius = variables.controller_radius = 1;
  variables.object_neighbours = 10;
  variables.controller_neighbours = 10;
  const SpringMassSystem system = MakePhysTwinSystem(recording, variables, false);
  int of_controller = 0;
  for (const auto& [a, b] : system.springs) of_controller += b == 30;
  EXPECT_EQ(of_controller, 10);
  int of_first = 0;  // the end of the rope: nobody else looks for more than its own 9
  for (const auto& [a, b] : system.springs) of_first += (a == 0 || b == 0) && b != 30;
  EXPECT_EQ(of_first, 9);
}

TEST(PhysTwinVariables, LetParticlesCollideOnlyIfAsked) {
  const Recording recording = SwungRope(8, 2);
  const PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 1);
  EXPECT_EQ(MakePhysTwinSystem(recording, variables, false).contact.collision_distance, 0);
  EXPECT_EQ(MakePhysTwinSystem(recording, variables, true).contact.collision_distance, 0.02);
}

TEST(PhysTwinVariables, TrainSheetsForHalfAsLong) {
  Recording sheet = RecordingOfMotion(SmallTwin(1), 2);
  EXPECT_EQ(PhysTwinPasses(sheet), 200);  // it has an inside
  EXPECT_EQ(PhysTwinPasses(SwungRope(30, 2)), 200);
  sheet.interior.resize(3, 0);
  sheet.points.assign(1, Points(3, 100));
  sheet.rest.resize(3, 100);
  for (int i = 0; i < 100; ++i) {
    sheet.rest.col(i) = 0.01 * Eigen::Vector3i(i % 10, i / 10, 0).cast<double>();
  }
  EXPECT_EQ(PhysTwinPasses(sheet), 100);
}

}  // namespace
}  // namespace physpring
