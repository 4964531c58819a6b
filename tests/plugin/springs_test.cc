// SPDX-License-Identifier: Apache-2.0
// The plugin physpring.springs against the trainer's simulator and MuJoCo's native tendons.
#include "plugin/springs.h"

#include <gtest/gtest.h>

#include "tests/support/level_scene.h"
#include "tests/support/random_system.h"
#include "twin/plugin_state.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

const Eigen::Vector3d kGravity(0.5, -1, -9.81);

double Greatest(const Points& difference) { return difference.colwise().norm().maxCoeff(); }

struct Motion {
  Points start, velocity;
  explicit Motion(const SpringMassSystem& system) {
    Random random(7);
    start = system.position.leftCols(system.node_count()) + random.Box(system.node_count(), 0.01);
    velocity = random.Box(system.node_count(), 0.5);
  }
};

Points PassiveForce(const SpringMassSystem& system, const LevelSceneOptions& options) {
  const Motion motion(system);
  LevelScene scene(system, options);
  scene.SetState(motion.start, motion.velocity);
  mj_forward(&scene.model(), scene.data());
  return Eigen::Map<const Points>(scene.data()->qfrc_passive, 3, system.node_count());
}

void ExpectPassiveForceOfTendons(LevelSceneOptions options) {
  const SpringMassSystem system = RandomSystem(72, 3, 11);
  const Points plugin = PassiveForce(system, options);
  options.plugin_springs = false;
  const Points tendons = PassiveForce(system, options);
  // rounding: measured 3e-14
  EXPECT_LT(Greatest(plugin - tendons), 1e-12 * Greatest(tendons));
}

TEST(Springs, PassiveForceIsThatOfTendons) { ExpectPassiveForceOfTendons({.gravity = kGravity}); }

TEST(Springs, PassiveForceIsThatOfTendonsUnderARotatedParent) {
  ExpectPassiveForceOfTendons(
      {.gravity = kGravity, .parent_pose = R"(pos="0.3 -0.2 0.1" euler="30 40 50")"});
}

// 2,000 sub-steps in free flight from random velocities, dragged by 3 controllers on random ways.
double DistanceFromSimulator(bool controller_velocity, int substeps_in_step,
                             int dashpot_stages = 1) {
  constexpr int kFrames = 20, kSubsteps = 100;
  constexpr double kSubstep = 0.5e-3;  // s
  SpringMassSystem system = RandomSystem(72, 3, 11);
  system.dashpot_stages = dashpot_stages;
  if (dashpot_stages > 1) system.dashpot *= 100;
  const Motion motion(system);
  LevelScene scene(system, {.timestep = kSubstep * substeps_in_step,
                            .substep = kSubstep,
                            .controller_velocity = controller_velocity,
                            .gravity = kGravity});
  scene.SetState(motion.start, motion.velocity);
  const Simulator<double> simulator(system, {.gravity = kGravity, .ground = {}},
                                    {.frame_time = kSubsteps * kSubstep,
                                     .substeps = kSubsteps,
                                     .controller_velocity = controller_velocity});
  Simulator<double>::Workspace workspace(simulator);
  NodeStates<double> state = simulator.MakeState(motion.start, motion.velocity);

  Random random(3);
  Points hands = system.position.rightCols(system.controllers);
  const PluginState before(scene.data()->plugin_state, system.node_count(), system.controllers);
  *before.known = 1;
  Eigen::Map<Points>(before.controllers, 3, system.controllers) = hands;
  double distance = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Points next = hands + random.Box(system.controllers, 0.02);
    simulator.AdvanceFrame({hands, next, {}}, &state, &workspace);
    for (int substep = substeps_in_step; substep <= kSubsteps; substep += substeps_in_step) {
      scene.SetControllers(hands + (next - hands) * (static_cast<double>(substep) / kSubsteps));
      scene.Step();
    }
    hands = next;
    distance = std::max(distance, Greatest(simulator.Positions(state) - scene.Positions()));
  }
  return distance;
}

TEST(Springs, TrajectoryIsThatOfTheSimulator) {
  for (bool controller_velocity : {false, true}) {
    for (int substeps_in_step : {1, 4, 20}) {
      // rounding: measured 1e-12
      EXPECT_LT(DistanceFromSimulator(controller_velocity, substeps_in_step), 1e-9)
          << controller_velocity << " " << substeps_in_step;
    }
  }
}

TEST(Springs, TrajectoryWithDashpotsInStagesIsThatOfTheSimulator) {
  for (int substeps_in_step : {1, 4}) {
    EXPECT_LT(DistanceFromSimulator(true, substeps_in_step, 6), 1e-9) << substeps_in_step;
  }
}

// Controller 1 lets go after frame 3, and takes hold again after frame 8.
TEST(Springs, ControllersLetGoAndTakeHold) {
  constexpr int kFrames = 14, kOpened = 4, kTaken = 9, kSubsteps = 20, kSubstepsInStep = 4;
  constexpr double kSubstep = 0.5e-3;  // s
  const SpringMassSystem system = RandomSystem(72, 3, 11);
  const Motion motion(system);
  LevelScene scene(
      system, {.timestep = kSubstep * kSubstepsInStep, .substep = kSubstep, .gravity = kGravity});
  scene.SetState(motion.start, motion.velocity);
  const PluginState plugin(scene.data()->plugin_state, system.node_count(), system.controllers);
  Points hands = system.position.rightCols(system.controllers);
  *plugin.known = 1;
  Eigen::Map<Points>(plugin.controllers, 3, system.controllers) = hands;
  const Simulator<double> simulator(
      system, {.gravity = kGravity, .ground = {}},
      {.frame_time = kSubsteps * kSubstep, .substeps = kSubsteps, .late = {false, true, false}});
  Simulator<double>::Workspace workspace(simulator);
  NodeStates<double> state = simulator.MakeState(motion.start, motion.velocity);
  Random random(3);
  for (int frame = 1; frame <= kFrames; ++frame) {
    const Points next = hands + random.Box(system.controllers, 0.02);
    FrameInput input{hands, next, {}};
    const bool open = frame >= kOpened && frame < kTaken;
    if (open) input.released = {false, true, false};
    if (frame == kTaken) {
      input.attached = {{false, true, false}, hands, simulator.Positions(state)};
    }
    simulator.AdvanceFrame(input, &state, &workspace);
    plugin.released[1] = open ? 1 : 0;
    for (int substep = kSubstepsInStep; substep <= kSubsteps; substep += kSubstepsInStep) {
      scene.SetControllers(hands + (next - hands) * (static_cast<double>(substep) / kSubsteps));
      scene.Step();
    }
    hands = next;
    EXPECT_LT(Greatest(simulator.Positions(state) - scene.Positions()), 1e-9) << frame;
    EXPECT_EQ(simulator.RestLengths(state) == system.rest_length, frame < kTaken);
  }
}

// After 20 ms from random velocities.
double DistanceFromTendons(double timestep) {
  constexpr double kSubstep = 50e-6, kTime = 20e-3;  // s
  const SpringMassSystem system = RandomSystem(72, 3, 11);
  const Motion motion(system);
  LevelScene plugin(system, {.timestep = timestep, .substep = kSubstep, .gravity = kGravity});
  LevelScene tendons(
      system,
      {.plugin_springs = false, .timestep = kSubstep, .substep = kSubstep, .gravity = kGravity});
  plugin.SetState(motion.start, motion.velocity);
  tendons.SetState(motion.start, motion.velocity);
  plugin.Step(static_cast<int>(std::lround(kTime / timestep)));
  tendons.Step(static_cast<int>(std::lround(kTime / kSubstep)));
  return Greatest(plugin.Positions() - tendons.Positions());
}

TEST(Springs, SubstepsLandWhereTendonsDo) {
  for (double timestep : {50e-6, 1e-3, 2e-3, 5e-3}) {
    EXPECT_LT(DistanceFromTendons(timestep), 1e-12) << timestep;
  }
}

}  // namespace
}  // namespace physpring
