// SPDX-License-Identifier: Apache-2.0
// The contact law in MuJoCo, with both plugins: against the trainer's simulator, and against
// closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/level_scene.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/topology.h"

namespace physpring {
namespace {

constexpr double kG = 9.81;  // m/s^2
const char* const kFloor = R"(<geom type="plane" size="0 0 1"/>)";

double Greatest(const Points& difference) { return difference.colwise().norm().maxCoeff(); }
double Mean(const Points& difference) { return difference.colwise().norm().mean(); }

// A soft body that has just been thrown at the floor.
struct Throw {
  SpringMassSystem system = RandomSystem(72, 0, 11);
  Points velocity = Points::Zero(3, 72);
  Throw() {
    system.position.row(2).array() += 0.01 - system.position.row(2).minCoeff();
    velocity.colwise() = Eigen::Vector3d(1, 0.5, -1);
    system.contact = {{0.5, 0.3}, {0.7, 0.3}, 0.01};
  }
};

constexpr double kSubstep = 0.25e-3;  // s

Simulation ThrowInSimulator(const Throw& thrown, int substeps) {
  Simulation simulation(thrown.system, {.gravity = {0, 0, -kG}, .ground = {{0, 0, 1, 0}}}, kSubstep,
                        substeps);
  simulation.SetVelocity(thrown.velocity);
  return simulation;
}

LevelScene ThrowInMujoco(const Throw& thrown, bool plugin_springs, int substeps) {
  LevelScene scene(thrown.system, {.plugin_springs = plugin_springs,
                                   .contact = true,
                                   .timestep = substeps * kSubstep,
                                   .substep = kSubstep,
                                   .world = kFloor});
  const Points position = thrown.system.position;
  scene.SetState(position, thrown.velocity);
  return scene;
}

void ExpectMotionOfSimulator(bool plugin_springs, int substeps,
                             FrictionCone cone = FrictionCone::kElliptic) {
  Throw thrown;
  thrown.system.contact.surface.cone = cone;
  Simulation simulation = ThrowInSimulator(thrown, substeps);
  LevelScene scene = ThrowInMujoco(thrown, plugin_springs, substeps);
  simulation.Advance(200 / substeps);
  scene.Step(200 / substeps);
  EXPECT_GT(scene.Positions().row(2).minCoeff(), 0) << "falls through the floor";
  // measured 1e-15 to 1e-12: rounding until an impact comes a sub-step earlier
  EXPECT_LT(Greatest(simulation.position() - scene.Positions()), 1e-6);
}

TEST(Contact, FloorIsThatOfTheSimulator) { ExpectMotionOfSimulator(true, 1); }
TEST(Contact, FloorWithSubstepsIsThatOfTheSimulator) { ExpectMotionOfSimulator(true, 8); }
TEST(Contact, FloorUnderTendonsIsThatOfTheSimulator) { ExpectMotionOfSimulator(false, 1); }

TEST(Contact, PyramidalFrictionIsThatOfTheSimulator) {
  ExpectMotionOfSimulator(true, 8, FrictionCone::kPyramidal);
}

TEST(Contact, StaysNearTheSimulatorFor100Frames) {
  const Throw thrown;
  constexpr int kSubsteps = 8, kSteps = 1600;  // 3.2 s
  Simulation simulation = ThrowInSimulator(thrown, kSubsteps);
  LevelScene scene = ThrowInMujoco(thrown, true, kSubsteps);
  double sum = 0;
  for (int frame = 0; frame < 100; ++frame) {
    simulation.Advance(kSteps / 100);
    scene.Step(kSteps / 100);
    sum += Mean(simulation.position() - scene.Positions());
  }
  RecordProperty("mean_difference_m", std::to_string(sum / 100));
  std::printf("mean difference over 100 frames: %.2g m\n", sum / 100);
  // chaotic: rounding decides when two particles hit
  EXPECT_LT(sum / 100, 1e-3);
}

SpringMassSystem Ball(double height, const ContactCoefficients& contact) {
  SpringMassSystem ball = Particles(Eigen::Vector3d(0, 0, height), 0.1);
  ball.contact = contact;
  ball.contact_radius.setConstant(0.01);
  return ball;
}

LevelSceneOptions OnFloor(double timestep) {
  return {.plugin_springs = false, .contact = true, .timestep = timestep, .world = kFloor};
}

TEST(Contact, BouncesToSquareOfRestitution) {
  const double e = 0.6, height = 0.5, h = 1e-4;
  LevelScene scene(Ball(height + 0.01, {{e, 0}, {0, 0}, 0}), OnFloor(h));
  const double fall = std::sqrt(2 * height / kG);
  scene.Step(static_cast<int>(fall * (1 + e) / h));  // to the top of the bounce
  // the step of the impact: v h = 0.3 mm
  EXPECT_NEAR(scene.Positions()(2, 0) - 0.01, e * e * height, 1e-3);
}

TEST(Contact, SlidesAsFarAsCoulombLets) {
  const double mu = 0.4, speed = 1, h = 1e-4;
  LevelScene scene(Ball(0.01, {{0, mu}, {0, 0}, 0}), OnFloor(h));
  scene.SetState(Eigen::Vector3d(0, 0, 0.01), Eigen::Vector3d(speed, 0, 0));
  scene.Step(static_cast<int>(1.2 * speed / (mu * kG) / h));
  EXPECT_NEAR(scene.Positions()(0, 0), speed * speed / (2 * mu * kG), 1e-3);
  EXPECT_LT(scene.Velocities().norm(), 2 * kG * h);
}

// A twin thrown at a free box, without gravity.
struct Crash {
  SpringMassSystem system = RandomSystem(30, 0, 5);
  LevelSceneOptions options{
      .plugin_springs = true, .contact = true, .gravity = {0, 0, 0}, .world = R"(
      <body pos="0.2 0.02 0"><freejoint/><geom type="box" size="0.05 0.1 0.1" mass="0.3"/></body>)"};
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  double box_speed = 0;

  void Run(double time) {
    system.drag = 0;
    system.contact = {{0.5, 0.3}, {0, 0}, 0};
    const ModelPtr model = CompileMjcf(LevelMjcf(system, options));
    const DataPtr data = MakeData(*model);
    const int first = model->nv - 3 * system.node_count();
    Eigen::Map<Points>(data->qvel + first, 3, system.node_count()).row(0).setConstant(1);
    for (int i = 0; i < std::lround(time / options.timestep); ++i) Step(*model, data.get());
    const Points velocity = Eigen::Map<const Points>(data->qvel + first, 3, system.node_count());
    box_speed = data->qvel[0];
    momentum = velocity * system.mass + 0.3 * Eigen::Map<const Eigen::Vector3d>(data->qvel);
  }
};

TEST(Contact, KeepsMomentumWithAFreeBody) {
  for (bool plugin_springs : {true, false}) {
    Crash crash;
    crash.options.plugin_springs = plugin_springs;
    crash.Run(0.2);
    EXPECT_GT(crash.box_speed, 0.1);
    const Eigen::Vector3d before(crash.system.mass.sum(), 0, 0);
    EXPECT_LT((crash.momentum - before).norm(), 1e-12) << plugin_springs;
  }
}

TEST(Contact, KeepsMomentumWithAFreeBodyWithSubsteps) {
  Crash crash;
  crash.options.timestep = 2e-3;
  crash.Run(0.2);
  EXPECT_GT(crash.box_speed, 0.1);
  const Eigen::Vector3d before(crash.system.mass.sum(), 0, 0);
  // springs and contacts keep momentum within a step, too; v_mean differs from v_end only while an
  // impact goes on
  EXPECT_LT((crash.momentum - before).norm(), 1e-12);
}

TEST(Contact, BodyGetsOppositeImpulse) {
  // a ball hits a box of three times its mass at rest in the middle, with e = 0.5:
  // v = (m - e M) / (m + M), V = (1 + e) m / (m + M)
  SpringMassSystem ball = Ball(0, {{0.5, 0}, {0, 0}, 0});
  const LevelSceneOptions options{
      .plugin_springs = false, .contact = true, .gravity = {0, 0, 0}, .world = R"(
      <body pos="0.1 0 0"><freejoint/><geom type="box" size="0.05 0.05 0.05" mass="0.3"/></body>)"};
  const ModelPtr model = CompileMjcf(LevelMjcf(ball, options));
  const DataPtr data = MakeData(*model);
  data->qvel[6] = 1;
  for (int i = 0; i < 200; ++i) Step(*model, data.get());
  EXPECT_NEAR(data->qvel[6], (0.1 - 0.5 * 0.3) / 0.4, 1e-12);
  EXPECT_NEAR(data->qvel[0], 1.5 * 0.1 / 0.4, 1e-12);
}

// A wall on a slide joint, far heavier than the twin, that moves into it.
TEST(Contact, MovingGeomPushesAsInTheSimulator) {
  Throw thrown;
  thrown.system.contact.collision_distance = 0;
  thrown.system.position.row(0).array() += 0.06 - thrown.system.position.row(0).minCoeff();
  const int steps = 60, substeps = 4;
  Simulation simulation(thrown.system, Weightless(), kSubstep, substeps);
  simulation.geoms.push_back({.half_size = {0.05, 1, 1}, .velocity = {1, 0.2, 0}});
  simulation.Advance(steps);

  const ModelPtr model = CompileMjcf(LevelMjcf(thrown.system, {.contact = true,
                                                               .timestep = substeps * kSubstep,
                                                               .substep = kSubstep,
                                                               .gravity = {0, 0, 0},
                                                               .world = R"(
      <body><inertial pos="0 0 0" mass="1e12" diaginertia="1 1 1"/>
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <geom type="box" size="0.05 1 1"/></body>)"}));
  const DataPtr data = MakeData(*model);
  data->qvel[0] = 1;
  data->qvel[1] = 0.2;
  for (int i = 0; i < steps; ++i) Step(*model, data.get());
  const Points moved = Eigen::Map<const Points>(data->qpos + 2, 3, thrown.system.node_count());
  EXPECT_GT(Greatest(moved), 0.01);
  EXPECT_LT(Greatest(simulation.position() - thrown.system.position - moved), 1e-9);
}

TEST(Contact, GeomOfHigherPriorityBringsItsFriction) {
  const double mu = 0.2, speed = 1, h = 1e-4;
  LevelSceneOptions options = OnFloor(h);
  options.world = R"(<geom type="plane" size="0 0 1" priority="3" friction="0.2 0 0"/>)";
  LevelScene scene(Ball(0.01, {{0, 0.4}, {0, 0}, 0}), options);
  scene.SetState(Eigen::Vector3d(0, 0, 0.01), Eigen::Vector3d(speed, 0, 0));
  scene.Step(static_cast<int>(1.2 * speed / (mu * kG) / h));
  EXPECT_NEAR(scene.Positions()(0, 0), speed * speed / (2 * mu * kG), 1e-3);
}

TEST(Contact, GeomOfHigherPriorityTakesTheBounce) {
  const double h = 1e-4, height = 0.1;
  LevelSceneOptions options = OnFloor(h);
  options.world = R"(<geom type="plane" size="0 0 1" priority="3"/>)";
  LevelScene scene(Ball(height + 0.01, {{0.6, 0.4}, {0, 0}, 0}), options);
  scene.Step(static_cast<int>(1.2 * std::sqrt(2 * height / kG) / h));
  EXPECT_LT(std::abs(scene.Positions()(2, 0) - 0.01), 1e-3);
  EXPECT_LT(scene.Velocities().norm(), 2 * kG * h);
}

// Two balls joined by a spring, between two fingers of 0.1 kg that something presses together.
TEST(Contact, FingersHoldWhatTheyPress) {
  const double force = 2;  // N, of each finger; the weight is 1 N
  SpringMassSystem pair = Particles((Points(3, 2) << -0.005, 0.005, 0, 0, 0, 0).finished(), 0.05);
  pair.springs = {{0, 1}};
  pair.stiffness = Eigen::VectorXd::Constant(1, 2000);
  pair.rest_length = Eigen::VectorXd::Constant(1, 0.01);
  pair.dashpot = Eigen::VectorXd::Constant(1, 5);
  pair.contact = {{0.2, 1}, {0, 0}, 0};
  pair.contact_radius.setConstant(0.005);
  const ModelPtr model = CompileMjcf(
      LevelMjcf(pair, {.contact = true, .timestep = 2e-3, .substep = 0.25e-3, .world = R"(
      <body pos="-0.02 0 0"><joint type="slide" axis="1 0 0"/>
        <geom type="box" size="0.01 0.02 0.02" mass="0.1"/></body>
      <body pos="0.02 0 0"><joint type="slide" axis="-1 0 0"/>
        <geom type="box" size="0.01 0.02 0.02" mass="0.1"/></body>)"}));
  const DataPtr data = MakeData(*model);
  for (int i = 0; i < 1500; ++i) {
    data->qfrc_applied[0] = data->qfrc_applied[1] = force;
    Step(*model, data.get());
  }
  const double squeezed = force / pair.stiffness[0];
  // 3 s without friction are 44 m, and fingers that creep meet in the middle: 20 mm
  EXPECT_NEAR(data->qpos[4], 0, 3e-3) << "slips";
  EXPECT_NEAR(data->qpos[0] + data->qpos[1], squeezed, 1e-3) << "sinks in";
}

// A soft block between two fingers that weigh far more, and that do not let it slip or vibrate.
TEST(Contact, HeavyFingersHoldStill) {
  const double spacing = 0.01;
  Points at(3, 48);  // 3 x 4 x 4
  for (int i = 0; i < 48; ++i) {
    const int row = i / 3, layer = row / 4;
    at.col(i) << i % 3 - 1, row % 4, layer;
  }
  at *= spacing;
  SpringMassSystem block = Particles(at, 0.002);
  block.springs = BuildSprings(at, 0, {}, {.radius = 1.8 * spacing, .max_neighbours = 47}, "block");
  const auto springs = static_cast<Eigen::Index>(block.springs.size());
  block.stiffness = Eigen::VectorXd::Constant(springs, 300);
  block.dashpot = Eigen::VectorXd::Constant(springs, 0.02);
  block.rest_length = SpringLengths(block.springs, at, {});
  block.contact = {{0.06, 0.5}, {0, 0}, 0};
  block.contact_radius.setConstant(0.004);
  const ModelPtr model = CompileMjcf(
      LevelMjcf(block, {.contact = true, .timestep = 2e-3, .substep = 0.25e-3, .world = R"(
      <body pos="-0.025 0.015 0.015"><joint type="slide" axis="1 0 0"/>
        <geom type="box" size="0.01 0.02 0.01" mass="1" priority="2" friction="1"/></body>
      <body pos="0.025 0.015 0.015"><joint type="slide" axis="-1 0 0"/>
        <geom type="box" size="0.01 0.02 0.01" mass="1" priority="2" friction="1"/></body>)"}));
  const DataPtr data = MakeData(*model);
  const auto height = [&] {  // of the block
    return Eigen::Map<const Points>(data->qpos + 2, 3, 48).row(2).mean();
  };
  const auto hold = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      for (int finger : {0, 1}) data->qfrc_applied[finger] = 3 - 20 * data->qvel[finger];
      Step(*model, data.get());
    }
  };
  hold(500);
  const double before = height();
  hold(1000);
  EXPECT_NEAR(height(), before, 1e-4) << "creeps";
  EXPECT_LT(Eigen::Map<const Points>(data->qvel + 2, 3, 48).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Contact, TwoTwinsBounceOffEachOther) {
  // equal balls head on: they leave with e times their speed
  SpringMassSystem ball = Ball(0, {{0, 0}, {0.5, 0}, 0});
  const std::string other = R"(
      <body name="other"><plugin instance="other"/>
        <body pos="0.1 0 0"><inertial pos="0 0 0" mass="0.1" diaginertia="1 1 1"/>
          <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
          <joint type="slide" axis="0 0 1"/>
          <geom size="0.01" margin="-0.5" gap="0.6"/></body></body>)";
  std::string mjcf = LevelMjcf(
      ball, {.plugin_springs = false, .contact = true, .gravity = {0, 0, 0}, .world = other});
  mjcf.replace(mjcf.find("</plugin></extension>"), 0,
               R"(<instance name="other"><config key="friction" value="0"/></instance>)");
  const ModelPtr model = CompileMjcf(mjcf);
  const DataPtr data = MakeData(*model);
  data->qvel[0] = -1;
  data->qvel[3] = 1;
  for (int i = 0; i < 200; ++i) Step(*model, data.get());
  EXPECT_NEAR(data->qvel[0], 0.5, 1e-12);
  EXPECT_NEAR(data->qvel[3], -0.5, 1e-12);
}

}  // namespace
}  // namespace physpring
