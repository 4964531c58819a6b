// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/start_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/plain_rope.h"
#include "tests/support/random_system.h"
#include "tests/support/swung_rope.h"
#include "twin/checks/objects.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kSafety = 0.7;

// A rope of particles 10 mm apart whose lowest one is `height` above a ground.
Recording AboveGround(double height) {
  Recording recording = SwungRope(8, 2);
  const double lowest = recording.start.leftCols(8).row(2).minCoeff();
  recording.ground = Eigen::Vector4d(0, 0, 1, lowest - height);
  return recording;
}

TEST(StartSystem, MassesSumToTheRecordings) {
  Recording recording = SwungRope(8, 2);
  recording.mass = 0.37;
  const SpringMassSystem system = MakeStartSystem(recording, {});
  EXPECT_EQ(system.mass.size(), 8);
  EXPECT_NEAR(system.mass.sum(), 0.37, 1e-15);
  EXPECT_EQ(system.mass.minCoeff(), system.mass.maxCoeff());
  EXPECT_NO_THROW(system.Validate("start"));
}

TEST(StartSystem, RodKnowsItsArcLengths) {
  Recording recording = SwungRope(8, 2);
  recording.rod = PlainRod(Eigen::VectorXd::LinSpaced(recording.rest.cols(), 0.08, 0));
  EXPECT_EQ(MakeStartSystem(recording, {}).rod.arc, recording.rod.arc);
}

TEST(StartSystem, SpringsAreStressFreeAndOfTheSameAxialStiffness) {
  Recording recording = SwungRope(8, 2);
  recording.rest *= 0.9;
  const SpringMassSystem system = MakeStartSystem(recording, {.max_neighbours = 4});
  const Eigen::VectorXd axial = system.stiffness.cwiseProduct(system.rest_length);
  EXPECT_NEAR(axial.minCoeff(), axial.maxCoeff(), 1e-12);
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    const double length = (recording.rest.col(b) - recording.rest.col(a)).norm();
    EXPECT_NEAR(system.rest_length[e], length, 1e-15) << e;
  }
}

TEST(StartSystem, BodyThatLiesOnTheGroundTouchesItWhereItLies) {
  const SpringMassSystem system = MakeStartSystem(AboveGround(0.003), {});
  EXPECT_NEAR(system.contact_radius.minCoeff(), 0.003, 1e-12);
  EXPECT_NEAR(system.contact_radius.maxCoeff(), 0.003, 1e-12);
}

TEST(StartSystem, BodyOffTheGroundHasNoContactRadius) {
  EXPECT_EQ(MakeStartSystem(AboveGround(0.2), {}).contact_radius.maxCoeff(), 0);
  EXPECT_EQ(MakeStartSystem(AboveGround(-0.002), {}).contact_radius.maxCoeff(), 0);
  EXPECT_EQ(MakeStartSystem(SwungRope(8, 2), {}).contact_radius.maxCoeff(), 0);
}

TEST(StartSystem, BodyThatFallsTouchesTheGroundWhereItComesToLie) {
  constexpr int kFrames = 40, kLies = 20;  // from this frame on
  Recording recording = AboveGround(0.2);
  const double ground = (*recording.ground)[3];
  Random noise(1);
  recording.points.assign(kFrames, recording.start.leftCols(recording.point_count()));
  for (int frame = kLies; frame < kFrames; ++frame) {
    recording.points[frame].row(2).setConstant(ground + 0.004);
    recording.points[frame] += noise.Box(recording.point_count(), 0.0005);
  }
  recording.points[30].col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  recording.train_frames = kFrames;
  EXPECT_NEAR(MakeStartSystem(recording, {}).contact_radius[0], 0.004, 0.0003);
  recording.train_frames = kLies;  // what comes later is not known
  EXPECT_EQ(MakeStartSystem(recording, {}).contact_radius[0], 0);
}

// In frame 0 it is no higher than its particles are apart, but does not lie yet.
TEST(StartSystem, BodyThatFallsALittleTouchesTheGroundWhereItComesToLie) {
  constexpr int kFrames = 40;
  for (const double start : {0.008, -0.001}) {
    Recording recording = AboveGround(start);
    recording.points.assign(kFrames, recording.start.leftCols(recording.point_count()));
    for (int frame = 2; frame < kFrames; ++frame) {
      recording.points[frame].row(2).setConstant((*recording.ground)[3] + 0.004);
    }
    recording.train_frames = kFrames;
    EXPECT_NEAR(MakeStartSystem(recording, {}).contact_radius[0], 0.004, 1e-12) << start;
  }
}

TEST(StartSystem, SaysThatThereIsNoBody) {
  Recording recording = SwungRope(8, 2);
  recording.rest.col(1) = recording.rest.col(0);
  EXPECT_THROW(MakeStartSystem(recording, {}), Error);
}

TEST(ScaleToSubsteps, GivesThatNumberOfSubsteps) {
  const SpringMassSystem start = MakeStartSystem(SwungRope(8, 2), {});
  for (double substeps : {2.0, 7.5, 64.0}) {
    SpringMassSystem system = start;
    ScaleToSubsteps(0.02, substeps, kSafety, &system);
    const StabilityBound bound = ComputeStabilityBound(system);
    EXPECT_NEAR(0.02 / (kSafety * bound.timestep), substeps, 0.01 * substeps);
    EXPECT_NEAR(bound.gamma_max, 0.5 * bound.omega_max, 0.01 * bound.omega_max);
  }
}

TEST(ScaleToSubsteps, ScalesAllSpringsAlike) {
  const SpringMassSystem start = MakeStartSystem(SwungRope(8, 2), {});
  SpringMassSystem system = start;
  ScaleToSubsteps(0.02, 10, kSafety, &system);
  const Eigen::VectorXd stiffness = system.stiffness.cwiseQuotient(start.stiffness);
  const Eigen::VectorXd dashpot = system.dashpot.cwiseQuotient(start.dashpot);
  EXPECT_NEAR(stiffness.minCoeff() / stiffness.maxCoeff(), 1, 1e-12);
  EXPECT_NEAR(dashpot.minCoeff() / dashpot.maxCoeff(), 1, 1e-12);
  EXPECT_EQ(system.rest_length, start.rest_length);
}

TEST(StartSystem, JoinsNoTwoObjects) {
  Recording recording = TwoRopes();
  const TopologyOptions four{.max_neighbours = 4, .controller_max_neighbours = 4};
  const auto across = [&](const SpringMassSystem& system) {
    return std::count_if(system.springs.begin(), system.springs.end(), [](const auto& spring) {
      const auto of_second = [](int i) { return i == 23 || (i >= 11 && i < 22); };
      return of_second(spring[0]) != of_second(spring[1]);
    });
  };
  EXPECT_GT(across(MakeStartSystem(recording, four)), 20);
  recording.object = FindObjects(recording);
  const SpringMassSystem system = MakeStartSystem(recording, four);
  EXPECT_EQ(across(system), 0);
  EXPECT_GT(system.spring_count(), 40);
  EXPECT_TRUE(system.UnjoinedControllers().empty());
}

}  // namespace
}  // namespace physpring
