// SPDX-License-Identifier: Apache-2.0
// Mocap bodies that touch nodes: they act with the velocity by which their poses change.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/felt_scene.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

constexpr double kG = 9.81, kH = 1e-3;  // m/s^2, s
constexpr double kRadius = 0.01;        // m

// And a second one far away, by a spring without force: physpring.springs asks for springs.
SpringMassSystem Ball(const Eigen::Vector3d& at, double restitution, double friction) {
  Points both(3, 2);
  both << at, at + Eigen::Vector3d(0, 0, 5);
  SpringMassSystem ball = Particles(both, 0.1);
  AddSpring(0, 1, 0, 1, 0, &ball);
  ball.contact = {{restitution, friction}, {0, 0}, 0};
  ball.contact_radius.setConstant(kRadius);
  return ball;
}

// Of one plugin or the other, with a mocap box. MuJoCo numbers it as body 1.
LevelSceneOptions WithBox(bool plugin_springs, const std::string& pose, const std::string& size,
                          double gravity = 0) {
  LevelSceneOptions options{.plugin_springs = plugin_springs,
                            .contact = true,
                            .timestep = kH,
                            .substep = kH / 4,
                            .gravity = {0, 0, -gravity}};
  options.world = R"(<body name="box" mocap="true" )" + pose + R"(><geom type="box" size=")" +
                  size + R"("/></body>)";
  return options;
}

// Moves the box by `step` (m) before each of `count` steps.
void Push(int count, const Eigen::Vector3d& step, const Felt& felt) {
  for (int i = 0; i < count; ++i) {
    Eigen::Map<Eigen::Vector3d>(felt.data->mocap_pos) += step;
    Step(*felt.model, felt.data.get());
  }
}

TEST(MocapContact, PushesAsTheGeomOfTheSimulator) {
  constexpr double kSubstep = 0.25e-3;
  SpringMassSystem system = RandomSystem(72, 0, 11);
  system.contact = {{0.5, 0.3}, {0.7, 0.3}, 0};
  system.position.row(0).array() += 0.06 - system.position.row(0).minCoeff();
  Simulation simulation(system, Weightless(), kSubstep, 4);
  const Eigen::Vector3d velocity(1, 0.2, 0);
  simulation.geoms.push_back({.half_size = {0.05, 1, 1}, .velocity = velocity});
  simulation.Advance(100);

  LevelSceneOptions options = WithBox(true, "", "0.05 1 1");
  options.substep = kSubstep;
  const Felt felt(Mjcf(system, options, ""));
  Push(100, kH * velocity, felt);
  const Points moved = Eigen::Map<const Points>(felt.data->qpos, 3, 72);
  EXPECT_GT(moved.colwise().norm().maxCoeff(), 0.01);
  // rounding
  EXPECT_LT((simulation.position() - system.position - moved).colwise().norm().maxCoeff(), 1e-9);
}

TEST(MocapContact, BounceIsThatOffAHeavyWall) {
  const double speed = 0.5;
  for (bool plugin_springs : {false, true}) {
    for (double e : {0.0, 0.6}) {
      const Felt felt(Mjcf(Ball({0.08, 0, 0}, e, 0.3), WithBox(plugin_springs, "", "0.05 0.1 0.1"),
                           OfBody("box")));
      double impulse = 0;
      for (int i = 0; i < 100; ++i) {
        Push(1, {speed * kH, 0, 0}, felt);
        impulse += kH * felt.data->sensordata[0];
      }
      EXPECT_NEAR(felt.data->qvel[0], (1 + e) * speed, 1e-12);
      EXPECT_NEAR(impulse, -0.1 * (1 + e) * speed, 1e-12);
      mj_kinematics(felt.model.get(), felt.data.get());
      const double gap = felt.data->qpos[0] + 0.08 - kRadius - 0.05 - felt.data->mocap_pos[0];
      EXPECT_GE(gap, -1e-12) << "penetrated";
    }
  }
}

// A rod that turns about its middle moves a ball that slides along it without friction, so that
// r'' = w^2 r.
TEST(MocapContact, PaddleTurns) {
  const double w = 2, time = 0.5, start = 0.1;
  for (bool plugin_springs : {false, true}) {
    const Felt felt(Mjcf(Ball({start, 0.02, 0}, 0, 0), WithBox(plugin_springs, "", "0.3 0.01 0.1"),
                         OfBody("box")));
    felt.data->qvel[0] = -w * 0.02;  // with the rod
    felt.data->qvel[1] = w * start;
    for (int i = 0; i <= std::lround(time / kH); ++i) {
      const double half = 0.5 * w * i * kH;
      felt.data->mocap_quat[0] = std::cos(half);
      felt.data->mocap_quat[3] = std::sin(half);
      Step(*felt.model, felt.data.get());
    }
    const double c = std::cos(w * time), s = std::sin(w * time);
    const double x = start + felt.data->qpos[0], y = 0.02 + felt.data->qpos[1];
    // the first step, before which the rod's velocity is not known, and the step's length
    EXPECT_NEAR(c * x + s * y, start * std::cosh(w * time), 2e-3);
    EXPECT_NEAR(-s * x + c * y, 0.02, 1e-3) << "on the rod";
  }
}

TEST(MocapContact, BeltDragsByFriction) {
  const double mu = 0.4, speed = 1;
  for (bool plugin_springs : {false, true}) {
    const Felt felt(Mjcf(Ball({0, 0, kRadius}, 0, mu),
                         WithBox(plugin_springs, R"(pos="0 0 -0.1")", "2 1 0.1", kG), ""));
    const int half = static_cast<int>(0.5 * speed / (mu * kG) / kH);
    Push(half, {speed * kH, 0, 0}, felt);
    // the belt's velocity is not known in the first step; qvel is the mean of a step's sub-steps
    EXPECT_NEAR(felt.data->qvel[0], mu * kG * kH * (half - 1), 0.5 * mu * kG * kH);
    Push(2 * half, {speed * kH, 0, 0}, felt);
    EXPECT_NEAR(felt.data->qvel[0], speed, 1e-9);
    EXPECT_NEAR(felt.data->qpos[2], 0, 1e-4);
  }
}

// The throw of a soft body at a box that is fixed, or a mocap body.
Points AfterThrow(bool is_mocap) {
  SpringMassSystem system = RandomSystem(72, 0, 11);
  system.contact = {{0.5, 0.3}, {0.7, 0.3}, 0.01};
  system.position.row(2).array() += 0.01 - system.position.row(2).minCoeff();
  LevelSceneOptions options = WithBox(true, R"(pos="0 0 -0.1")", "1 1 0.1", kG);
  const std::string mjcf = Mjcf(system, options, "");
  const Felt felt(is_mocap ? mjcf : Replaced(mjcf, R"(mocap="true")", ""));
  Eigen::Map<Points>(felt.data->qvel, 3, 72).colwise() = Eigen::Vector3d(1, 0.5, -1);
  for (int i = 0; i < 200; ++i) Step(*felt.model, felt.data.get());
  return Eigen::Map<const Points>(felt.data->qpos, 3, 72);
}

TEST(MocapContact, StandingBodyIsAFixedOne) { EXPECT_EQ(AfterThrow(true), AfterThrow(false)); }

TEST(MocapContact, JumpAfterAResetHasNoVelocity) {
  for (bool plugin_springs : {false, true}) {
    const Felt felt(
        Mjcf(Ball({0.08, 0, 0}, 0.5, 0.3), WithBox(plugin_springs, "", "0.05 0.1 0.1"), ""));
    Push(5, {1e-3, 0, 0}, felt);
    mj_resetData(felt.model.get(), felt.data.get());
    Push(1, {0.0199, 0, 0}, felt);  // 0.1 mm from the ball
    Push(5, {0, 0, 0}, felt);
    EXPECT_EQ(felt.data->qvel[0], 0);
  }
}

TEST(MocapContact, CopiesKnowWhereTheBodyWas) {
  for (bool plugin_springs : {false, true}) {
    const Felt felt(
        Mjcf(Ball({0.08, 0, 0}, 0.5, 0.3), WithBox(plugin_springs, "", "0.05 0.1 0.1"), ""));
    Push(19, {1e-3, 0, 0}, felt);
    const DataPtr copy(mj_copyData(nullptr, felt.model.get(), felt.data.get()));
    Push(3, {1e-3, 0, 0}, felt);
    for (int i = 0; i < 3; ++i) {
      copy->mocap_pos[0] += 1e-3;
      mj_step(felt.model.get(), copy.get());
    }
    EXPECT_GT(felt.data->qvel[0], 1);
    EXPECT_EQ(copy->qvel[0], felt.data->qvel[0]);
  }
}

}  // namespace
}  // namespace physpring
