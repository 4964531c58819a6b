// SPDX-License-Identifier: Apache-2.0
#include "twin/path_simulator.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/small_twin.h"
#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {
namespace {

constexpr int kFrames = 8, kSubsteps = 20;

// The small twin's level 0 with controllers that are late by an odd part of a frame.
struct Late {
  Twin twin = SmallTwin(1);
  Recording recording;
  Late() {
    twin.levels[0].system.effects = {{"control_latency", Eigen::VectorXd::Constant(1, 0.013)}};
    recording = RecordingOfMotion(twin, kFrames);
    recording.velocity.setConstant(0.1);
  }
  PathStart start() const {
    return {recording.start.leftCols(recording.particle_count()), recording.velocity};
  }
  std::unique_ptr<PathSimulator> simulator(bool single_precision = false) const {
    return MakePathSimulator(
        twin.levels[0].system, EnvironmentOf(recording),
        {recording.fps, kSubsteps, twin.controller_velocity, single_precision});
  }
};

TEST(PathSimulator, MovesAsPredictDoes) {
  const Late late;
  for (const bool single_precision : {false, true}) {
    const auto predicted = Predict(late.twin, 0, late.recording, {single_precision, kSubsteps});
    const auto simulator = late.simulator(single_precision);
    const PathMotion motion = simulator->Roll(late.start(), late.recording.controllers);
    EXPECT_EQ(motion.position, predicted);

    // and frame by frame
    PathState state = simulator->MakeState(late.start(), late.recording.controllers[0]);
    for (int frame = 1; frame < kFrames; ++frame) {
      simulator->Advance(late.recording.controllers[frame], &state);
      EXPECT_EQ(simulator->Of(state).position, motion.position[frame]);
      EXPECT_EQ(simulator->Of(state).velocity, motion.velocity[frame]);
    }
  }
}

// loss = sum of weights times positions and velocities
struct WeightedLoss {
  std::vector<Points> position, velocity;
  long double Of(const PathMotion& motion) const {
    long double loss = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      for (double term : motion.position[frame].cwiseProduct(position[frame]).reshaped()) {
        loss += term;
      }
      for (double term : motion.velocity[frame].cwiseProduct(velocity[frame]).reshaped()) {
        loss += term;
      }
    }
    return loss;
  }
};

TEST(PathSimulator, GradientMatchesDifferences) {
  Late late;
  Random random(3);
  WeightedLoss loss;
  const int nodes = late.recording.particle_count();
  for (int frame = 0; frame < kFrames; ++frame) {
    loss.position.push_back(random.Box(nodes, 1));
    loss.velocity.push_back(random.Box(nodes, 0.02));
  }
  PathStart start = late.start();
  std::vector<Points> path = late.recording.controllers;
  const PathGradient gradient =
      late.simulator()->Gradient(start, path, loss.position, loss.velocity);
  std::vector<CheckedVariable> checked;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int i = 0; i < path[frame].size(); ++i) {
      checked.push_back(
          {"controller", path[frame].data() + i, 1e-4, gradient.controllers[frame].data()[i]});
    }
  }
  for (int i = 0; i < 12; ++i) {
    checked.push_back({"position", start.position.data() + i, 1e-4, gradient.position.data()[i]});
    checked.push_back({"velocity", start.velocity.data() + i, 1e-2, gradient.velocity.data()[i]});
  }
  SpringMassSystem& system = late.twin.levels[0].system;
  for (int i = 0; i < 5; ++i) {
    checked.push_back({"stiffness", &system.stiffness[i], 1e-2 * system.stiffness[i],
                       gradient.system.stiffness[i]});
  }
  checked.push_back({"latency", &system.effects[0].values[0], 1e-4, gradient.system.effects[0][0]});
  const GradientReport report = CheckGradient(
      [&] { return loss.Of(late.simulator()->Roll(start, path)); }, checked, 1e-6, 1e-2);
  EXPECT_TRUE(report.passed) << report.log;
}

TEST(PathSimulator, KnowsItsOwnStates) {
  const Late late;
  const auto simulator = late.simulator();
  PathState state = simulator->MakeState(late.start(), late.recording.controllers[0]);
  EXPECT_NO_THROW(simulator->ExpectOwn(state));
  PathState other = state;
  other.fps = 7;
  EXPECT_THROW(simulator->ExpectOwn(other), Error);
  other = state;
  other.nodes.pop_back();
  EXPECT_THROW(simulator->ExpectOwn(other), Error);
  other = state;
  other.path.clear();
  EXPECT_THROW(simulator->ExpectOwn(other), Error);
  other = state;
  other.path.emplace_back(3, 1);
  EXPECT_THROW(simulator->ExpectOwn(other), Error);
}

TEST(PathSimulator, SaysWhereAMotionDiverges) {
  Late late;
  late.twin.levels[0].system.stiffness *= 1e9;
  try {
    late.simulator()->Roll(late.start(), late.recording.controllers);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("the motion diverges in frame "))
        << error.what();
  }
}

}  // namespace
}  // namespace physpring
