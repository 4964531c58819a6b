// SPDX-License-Identifier: Apache-2.0
// The gradient of a loss over several frames against differences, for every learnable quantity.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/targeted_rollout.h"

namespace physpring {
namespace {

// Without contact the loss is smooth: a long step has the least rounding.
constexpr double kSmooth = 1e-3;
// With contacts the loss jumps where an impact moves to the next sub-step: the step must be shorter
// than the way to the next jump.
constexpr double kContact = 1e-5;

void ExpectGradientMatches(const TargetedRollout& rollout, double step) {
  for (const GradientReport& report : CheckRollout(rollout, step)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

bool HasSurfaceContact(const TargetedRollout& rollout) {
  return Gradient<double>(rollout).system.contact.surface.restitution != 0;
}

TEST(SimulatorAdjoint, MatchesDifferencesWithoutContact) {
  ExpectGradientMatches(RandomRollout(4, 1), kSmooth);
}

TEST(SimulatorAdjoint, MatchesDifferencesWithoutControllerVelocity) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.options.controller_velocity = false;
  ExpectGradientMatches(rollout, kSmooth);
}

// A network that falls on the ground at 1 m/s.
TargetedRollout OnTheGround(double restitution, double friction) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.085);
  rollout.velocity.row(2).array() -= 1;
  rollout.system.contact.surface.restitution = restitution;
  rollout.system.contact.surface.friction = friction;
  return rollout;
}

TEST(SimulatorAdjoint, MatchesDifferencesWhenBouncing) {
  const TargetedRollout rollout = OnTheGround(0.9, 0.1);
  ASSERT_TRUE(HasSurfaceContact(rollout));
  ExpectGradientMatches(rollout, kContact);
}

TEST(SimulatorAdjoint, MatchesDifferencesWhenSliding) {
  const TargetedRollout rollout = OnTheGround(0, 0.02);
  ASSERT_TRUE(HasSurfaceContact(rollout));
  ExpectGradientMatches(rollout, kContact);
}

TEST(SimulatorAdjoint, MatchesDifferencesWhenSticking) {
  const TargetedRollout rollout = OnTheGround(0, 2);
  ASSERT_TRUE(HasSurfaceContact(rollout));
  ExpectGradientMatches(rollout, kContact);
}

std::vector<Geom> BoxSphereAndCapsule() {
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
  return {box, sphere, capsule};
}

TEST(SimulatorAdjoint, MatchesDifferencesAmongMovingGeoms) {
  TargetedRollout rollout = RandomRollout(4, 1);
  for (FrameInput& input : rollout.frames) input.geoms = BoxSphereAndCapsule();
  ASSERT_TRUE(HasSurfaceContact(rollout));
  ExpectGradientMatches(rollout, kContact);
}

// Particles that are far apart in the reference are near now.
TargetedRollout WithCollisions() {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.position *= 0.5;
  rollout.velocity *= 3;
  rollout.system.contact.collision_distance = 0.03;
  return rollout;
}

TEST(SimulatorAdjoint, MatchesDifferencesWithCollidingParticles) {
  const TargetedRollout rollout = WithCollisions();
  ASSERT_NE(Gradient<double>(rollout).system.contact.object.friction, 0);
  ExpectGradientMatches(rollout, kContact);
}

TEST(SimulatorAdjoint, MatchesDifferencesWithAllContactsAtOnce) {
  TargetedRollout rollout = WithCollisions();
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.045);
  for (FrameInput& input : rollout.frames) input.geoms = BoxSphereAndCapsule();
  rollout.options.controller_velocity = false;
  const ContactLaws<double> laws = Gradient<double>(rollout).system.contact;
  ASSERT_NE(laws.surface.friction, 0);
  ASSERT_NE(laws.object.friction, 0);
  ExpectGradientMatches(rollout, kContact);
}

TEST(SimulatorAdjoint, AddsToWhatIsThere) {
  const TargetedRollout rollout = WithCollisions();
  const Simulator<double> simulator(rollout.system, rollout.environment, rollout.options);
  Simulator<double>::Workspace workspace(simulator);
  const NodeStates<double> start = simulator.MakeState(rollout.position, rollout.velocity);
  SystemGradient gradient(rollout.system);
  const auto add = [&] {
    NodeStates<double> bar = simulator.MakeState(rollout.target[0], rollout.target[1]);
    simulator.AdvanceFrameAdjoint(start, rollout.frames[0], &bar, &gradient, &workspace);
  };
  add();
  const SystemGradient once = gradient;
  SystemGradient sum = once;
  sum += once;
  add();
  for (const SystemGradient& twice : {gradient, sum}) {  // x + x is exact
    EXPECT_EQ(twice.stiffness, 2 * once.stiffness);
    EXPECT_EQ(twice.rest_length, 2 * once.rest_length);
    EXPECT_EQ(twice.dashpot, 2 * once.dashpot);
    EXPECT_EQ(twice.mass, 2 * once.mass);
    EXPECT_EQ(twice.drag, 2 * once.drag);
    EXPECT_EQ(twice.gravity, 2 * once.gravity);
    EXPECT_EQ(twice.contact.surface.restitution, 2 * once.contact.surface.restitution);
    EXPECT_EQ(twice.contact.surface.friction, 2 * once.contact.surface.friction);
    EXPECT_EQ(twice.contact.object.restitution, 2 * once.contact.object.restitution);
    EXPECT_EQ(twice.contact.object.friction, 2 * once.contact.object.friction);
  }
}

TEST(SimulatorAdjoint, GivesControllersNoGradient) {
  const TargetedRollout rollout = RandomRollout(1, 1);
  const Simulator<double> simulator(rollout.system, rollout.environment, rollout.options);
  Simulator<double>::Workspace workspace(simulator);
  const NodeStates<double> start = simulator.MakeState(rollout.position, rollout.velocity);
  NodeStates<double> bar = simulator.MakeState(rollout.position, rollout.velocity);
  SystemGradient gradient(rollout.system);
  simulator.AdvanceFrameAdjoint(start, rollout.frames[0], &bar, &gradient, &workspace);
  for (std::size_t i = simulator.node_count(); i < bar.size(); ++i) {
    for (int j = 0; j < 4; ++j) {
      EXPECT_EQ(bar[i].x[j], 0);
      EXPECT_EQ(bar[i].v[j], 0);
    }
  }
}

// |float - double| / |double| of a whole quantity.
template <class Derived>
double RelativeError(const Eigen::MatrixBase<Derived>& rounded,
                     const Eigen::MatrixBase<Derived>& exact) {
  return (rounded - exact).norm() / exact.norm();
}

// A float has 6e-8; 40 sub-steps, and differences of positions, lose two digits.
void ExpectFloatIsDouble(const TargetedRollout& rollout, double tolerance) {
  EXPECT_LT(RelativeError(Simulate<float>(rollout).back(), Simulate<double>(rollout).back()),
            tolerance);
  const RolloutGradient rounded = Gradient<float>(rollout), exact = Gradient<double>(rollout);
  const SystemGradient& p = rounded.system;
  const SystemGradient& q = exact.system;
  EXPECT_LT(RelativeError(p.stiffness, q.stiffness), tolerance);
  EXPECT_LT(RelativeError(p.rest_length, q.rest_length), tolerance);
  EXPECT_LT(RelativeError(p.dashpot, q.dashpot), tolerance);
  EXPECT_LT(RelativeError(p.mass, q.mass), tolerance);
  EXPECT_LT(RelativeError(p.gravity, q.gravity), tolerance);
  EXPECT_LT(RelativeError(rounded.position, exact.position), tolerance);
  EXPECT_LT(RelativeError(rounded.velocity, exact.velocity), tolerance);
  EXPECT_NEAR(p.drag, q.drag, tolerance * std::abs(q.drag));
  EXPECT_NEAR(p.contact.surface.restitution, q.contact.surface.restitution,
              tolerance * std::abs(q.contact.surface.restitution));
  EXPECT_NEAR(p.contact.surface.friction, q.contact.surface.friction,
              tolerance * std::abs(q.contact.surface.friction));
}

TEST(SimulatorAdjoint, OfFloatIsThatOfDouble) {
  ExpectFloatIsDouble(RandomRollout(4, 1), 1e-5);
  ExpectFloatIsDouble(OnTheGround(0.5, 0.3), 1e-5);
}

}  // namespace
}  // namespace physpring
