// SPDX-License-Identifier: Apache-2.0
// The sensors physpring.force against weights, actuators and changes of momentum.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/felt_scene.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

constexpr double kG = 9.81;  // m/s^2
const char* const kFloor = R"(<geom type="plane" size="0 0 1"/>)";
constexpr double kWeight = 4 * 0.05 * kG;  // N, of four nodes

LevelSceneOptions OnFloor(bool plugin_springs) {
  const double h = plugin_springs ? 2e-3 : 0.25e-3;
  return {.plugin_springs = plugin_springs,
          .contact = true,
          .timestep = h,
          .substep = 0.25e-3,
          .world = kFloor};
}

// The mean forces at rest: of the floor, then of the nodes.
Eigen::VectorXd RestingForces(const std::string& mjcf) {
  Felt felt(mjcf);
  felt.Run(static_cast<int>(2 / felt.model->opt.timestep));
  return felt.Mean(200);
}

void ExpectWeight(const Eigen::VectorXd& mean) {
  const Vector3d floor = mean.head<3>();
  const Vector3d nodes = Eigen::Map<const Points>(mean.data() + 6, 3, 4).rowwise().sum();
  EXPECT_LT((floor + Vector3d(0, 0, kWeight)).norm(), 0.01 * kWeight);
  EXPECT_LT((nodes - Vector3d(0, 0, kWeight)).norm(), 0.01 * kWeight);
}

TEST(Force, FloorAndNodesFeelTheWeight) {
  for (bool plugin_springs : {true, false}) {
    ExpectWeight(RestingForces(
        Mjcf(Pyramid(), OnFloor(plugin_springs), OfBody("world") + OfNodes("rope", 4))));
  }
}

TEST(Force, ContactsLeftToMujocoGiveTheSame) {
  const std::string mjcf = Mjcf(Pyramid(), OnFloor(true), OfBody("world") + OfNodes("rope", 4));
  ExpectWeight(RestingForces(
      Replaced(mjcf, R"(margin="-0.5" gap="0.6")", R"(margin="0" solref="0.004 1")")));
}

TEST(Force, FixedBodyFeelsWhatIsOnItAlone) {
  LevelSceneOptions options = OnFloor(true);
  options.world = R"(<geom type="plane" pos="0 0 -1" size="0 0 1"/>
      <body name="table" pos="0.05 0.03 -0.1">
        <body pos="0 0 0.05"><geom type="box" size="0.5 0.5 0.05"/></body></body>)";
  ExpectWeight(RestingForces(Mjcf(Pyramid(), options, OfBody("table") + OfNodes("rope", 4))));
}

// Two heavy fingers hold the square, with limited force.
TEST(Force, FingersFeelWeightAndGrip) {
  LevelSceneOptions options = OnFloor(true);
  options.world = R"(
      <body name="left" pos="-0.03 0.03 0.03">
        <joint name="l" type="slide" axis="1 0 0" damping="20"/>
        <geom type="box" size="0.02 0.1 0.1" mass="5" priority="2" friction="2"/></body>
      <body name="right" pos="0.13 0.03 0.03">
        <joint name="r" type="slide" axis="1 0 0" damping="20"/>
        <geom type="box" size="0.02 0.1 0.1" mass="5" priority="2" friction="2"/></body>)";
  Felt felt(Mjcf(Square(), options, OfBody("left") + OfBody("right"), R"(<actuator>
      <position joint="l" kp="1000" ctrlrange="-1 1" forcerange="-4 4"/>
      <position joint="r" kp="1000" ctrlrange="-1 1" forcerange="-4 4"/></actuator>)"));
  felt.data->ctrl[0] = 0.5;
  felt.data->ctrl[1] = -0.5;
  felt.Run(2000);
  const Eigen::VectorXd mean = felt.Mean(200);
  EXPECT_NEAR(mean[2] + mean[8], -kWeight, 0.01 * kWeight);
  EXPECT_NEAR(mean[0] + mean[6], 0, 0.01 * 4);
  EXPECT_EQ(felt.data->actuator_force[0], 4);
  EXPECT_NEAR(mean[0], -4, 0.03 * 4);
}

// A twin hits a free cube, which turns: impulse and moment are the changes of momentum. Its inertia
// is the same about all axes, so that the step of a turning body keeps its angular momentum.
void ExpectBalance(double mass, bool plugin_springs, double timestep) {
  SpringMassSystem system = RandomSystem(30, 0, 5);
  system.drag = 0;
  system.contact = {{0.5, 0.3}, {0, 0}, 0};
  const std::string inertia = std::to_string(mass * 0.01);
  Felt felt(Mjcf(system,
                 {.plugin_springs = plugin_springs,
                  .contact = true,
                  .timestep = timestep,
                  .gravity = {0, 0, 0},
                  .world = R"(<body name="cube" pos="0.2 0.05 0.03"><freejoint/>
         <inertial pos="0 0 0" mass=")" +
                           std::to_string(mass) + R"(" diaginertia=")" + inertia + " " + inertia +
                           " " + inertia + R"("/><geom type="box" size="0.05 0.1 0.1"/></body>)"},
                 OfBody("cube") + OfNodes("rope", 30)));
  Eigen::Map<Points>(felt.data->qvel + 6, 3, 30).row(0).setConstant(1);
  const int steps = static_cast<int>(std::lround(0.2 / timestep));
  const Eigen::VectorXd impulse = felt.Mean(steps) * steps * timestep;
  mj_kinematics(felt.model.get(), felt.data.get());
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(felt.data->xmat + 9);
  const Vector3d momentum = mass * Eigen::Map<const Vector3d>(felt.data->qvel);
  const Vector3d angular =
      axes * Eigen::Map<const Vector3d>(felt.data->qvel + 3) * std::stod(inertia);
  const Vector3d nodes = Eigen::Map<const Points>(impulse.data() + 6, 3, 30).rowwise().sum();
  EXPECT_GT(momentum[0], 0.1);
  EXPECT_GT(angular.norm(), 1e-3);
  // rounding
  EXPECT_LT((impulse.head<3>() - momentum).norm(), 1e-12) << mass;
  EXPECT_LT((impulse.segment<3>(3) - angular).norm(), 1e-12) << mass;
  EXPECT_LT((nodes + momentum).norm(), 1e-12) << mass;
}

TEST(Force, ImpulseIsTheChangeOfMomentum) {
  for (double mass : {0.3, 30.0}) {
    ExpectBalance(mass, true, 2e-3);
    ExpectBalance(mass, true, 0.5e-3);
    ExpectBalance(mass, false, 0.5e-3);
  }
}

// Two equal balls head on, of two twins: e = 0.5.
TEST(Force, TwinsFeelEachOther) {
  SpringMassSystem ball = Particles(Vector3d::Zero(), 0.1);
  ball.contact = {{0, 0}, {0.5, 0}, 0};
  ball.contact_radius.setConstant(0.01);
  const std::string other = R"(
      <body name="other"><plugin instance="other"/>
        <body name="ball" pos="0.1 0 0"><inertial pos="0 0 0" mass="0.1" diaginertia="1 1 1"/>
          <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
          <joint type="slide" axis="0 0 1"/>
          <geom size="0.01" margin="-0.5" gap="0.6"/></body></body>)";
  const std::string mjcf =
      Mjcf(ball, {.plugin_springs = false, .contact = true, .gravity = {0, 0, 0}, .world = other},
           OfNodes("rope", 1) + OfNodes("other", 1) + OfBody("ball"));
  Felt felt(Replaced(mjcf, "</plugin></extension>",
                     R"(<instance name="other"><config key="friction" value="0"/></instance>)"
                     "</plugin></extension>"));
  felt.data->qvel[0] = -1;
  felt.data->qvel[3] = 1;
  const Eigen::VectorXd impulse = felt.Mean(200) * 200 * felt.model->opt.timestep;
  EXPECT_NEAR(impulse[0], -0.1 * 1.5, 1e-12);
  EXPECT_NEAR(impulse[3], 0.1 * 1.5, 1e-12);
  EXPECT_NEAR(impulse[6], 0.1 * 1.5, 1e-12);
}

// A ball that hangs on a spring, at rest.
SpringMassSystem Hanging() {
  SpringMassSystem hanging = Particles((Points(3, 2) << 0, 0, 0, 0, 0, 0.1).finished(), 0.2, 1);
  AddSpring(0, 1, 200, 0.1 - 0.2 * kG / 200, 1, &hanging);
  return hanging;
}

TEST(Force, ControllersFeelTheSprings) {
  const std::string mjcf = Mjcf(Hanging(), {.contact = true}, OfBody("rope_1"));
  const std::string moves = Replaced(
      mjcf, R"(mocap="true" pos="0 0 0.1">)",
      R"(pos="0 0 0.1"><joint type="slide" axis="1 0 0"/><geom size="0.01" mass="1e6" contype="0"/>)");
  ASSERT_NE(mjcf, moves);
  for (const std::string& scene : {mjcf, moves}) {
    Felt felt(scene);
    felt.Run(10);
    EXPECT_NEAR(felt.Of(0)[2], -0.2 * kG, 1e-3);
  }
}

}  // namespace
}  // namespace physpring
