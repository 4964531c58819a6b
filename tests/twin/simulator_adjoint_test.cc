// SPDX-License-Identifier: Apache-2.0
// The gradient of a loss over several frames against differences, for every learnable quantity.
#include <gtest/gtest.h>

#include "tests/support/rollout.h"

namespace physpring {
namespace {

// Without contact the loss is smooth: a long step has the least rounding.
constexpr double kSmooth = 1e-3;
// With contacts the loss jumps where an impact moves to the next sub-step: the step must be shorter
// than the way to the next jump.
constexpr double kContact = 1e-5;

void ExpectGradientMatches(const Rollout& rollout, double step) {
  for (const GradientReport& report : CheckRollout(rollout, step)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

bool HasSurfaceContact(const Rollout& rollout) {
  return Gradient<double>(rollout).system.contact.surface.restitution != 0;
}

TEST(SimulatorAdjoint, MatchesDifferencesWithoutContact) {
  ExpectGradientMatches(RandomRollout(4, 1), kSmooth);
}

TEST(SimulatorAdjoint, MatchesDifferencesWithoutControllerVelocity) {
  Rollout rollout = RandomRollout(4, 1);
  rollout.options.controller_velocity = false;
  ExpectGradientMatches(rollout, kSmooth);
}

TEST(SimulatorAdjoint, MatchesDifferencesOnTheGround) {
  Rollout rollout = RandomRollout(4, 1);
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.085);
  ASSERT_TRUE(HasSurfaceContact(rollout));
  ExpectGradientMatches(rollout, kContact);
}

TEST(SimulatorAdjoint, MatchesDifferencesAmongMovingGeoms) {
  Rollout rollout = RandomRollout(4, 1);
  for (FrameInput& input : rollout.frames) {
    Geom box;
    box.half_size = {0.02, 0.03, 0.04};
    box.position = {0.06, 0, 0};
    box.velocity = {-0.3, 0.1, 0.2};
    box.angular_velocity = {3, 4, -5};
    Geom sphere;
    sphere.radius = 0.03;
    sphere.position = {-0.05, 0, 0};
    sphere.velocity = {0.3, 0.1, 0};
    Geom capsule;
    capsule.radius = 0.02;
    capsule.half_size = {0, 0, 0.05};
    capsule.position = {0, -0.08, 0};
    capsule.velocity = {0, 0.5, 0};
    capsule.angular_velocity = {1, -2, 1};
    input.geoms = {box, sphere, capsule};
  }
  ASSERT_TRUE(HasSurfaceContact(rollout));
  ExpectGradientMatches(rollout, kContact);
}

TEST(SimulatorAdjoint, MatchesDifferencesWithCollidingParticles) {
  Rollout rollout = RandomRollout(4, 1);
  rollout.position *= 0.5;  // particles that are far apart in the reference are near now
  rollout.velocity *= 3;
  rollout.system.contact.collision_distance = 0.03;
  ASSERT_NE(Gradient<double>(rollout).system.contact.object.friction, 0);
  ExpectGradientMatches(rollout, kContact);
}

}  // namespace
}  // namespace physpring
