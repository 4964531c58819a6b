// SPDX-License-Identifier: Apache-2.0
#include "tracker/tracked_body.h"

#include <gtest/gtest.h>

#include "tests/support/random_system.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kFps = 30;

TEST(BodyToTrack, ComesCloserToTheBoundThanRollouts) {
  const SpringMassSystem system = RandomSystem(40, 0, 2);
  const StabilityBound bound = ComputeStabilityBound(system);
  const TrackedBody body = BodyToTrack(system, kFps, 0);
  EXPECT_LT(body.substeps, StableSubsteps(bound, 1 / kFps, kStepSafety));
  EXPECT_LT(1 / kFps / body.substeps, bound.timestep);
  EXPECT_EQ(body.system.stiffness, system.stiffness);
  EXPECT_EQ(BodyToTrack(system, kFps, 10 * body.substeps).substeps, 10 * body.substeps);
}

TEST(BodyToTrack, SoftensTheStiffestForFewerSubsteps) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  system.mass[7] *= 1e-2;  // a light node between others
  const int substeps = BodyToTrack(system, kFps, 0).substeps / 3;
  const TrackedBody body = BodyToTrack(system, kFps, substeps);
  EXPECT_EQ(body.substeps, substeps);
  EXPECT_LT(1 / kFps / substeps, ComputeStabilityBound(body.system).timestep);
  const auto softer = body.system.stiffness.array() < system.stiffness.array();
  EXPECT_GT(body.softened, 0);
  EXPECT_LT(body.softened, 1);
  EXPECT_NEAR(body.softened * system.spring_count(), softer.count(), 1e-9);
  EXPECT_EQ(BodyToTrack(system, kFps, 0).softened, 0);
}

TEST(BodyToTrack, TakesAsManyStagesAsItNeeds) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  system.dashpot *= 100;
  system.dashpot_stages = 8;
  const TrackedBody few = BodyToTrack(system, kFps, 0);
  EXPECT_GT(few.system.dashpot_stages, 1);
  const TrackedBody many = BodyToTrack(system, kFps, 100 * few.substeps);
  EXPECT_EQ(many.system.dashpot_stages, 1);
  EXPECT_LT(1 / kFps / many.substeps, ComputeStabilityBound(many.system).timestep);
}

}  // namespace
}  // namespace physpring
