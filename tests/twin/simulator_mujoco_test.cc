// SPDX-License-Identifier: Apache-2.0
// The simulator against MuJoCo: contact-free trajectories of a soft random network are those of
// MuJoCo's native tendons, to rounding.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_system.h"
#include "tests/support/tendon_oracle.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

constexpr int kFrames = 20;
constexpr int kSubsteps = 100;       // a frame: 2,000 in all
constexpr double kFrameTime = 0.05;  // s
const Eigen::Vector3d kGravity(0.5, -1, -9.81);

struct Distance {
  double nodes = 0;      // m, the greatest between simulator and oracle after any frame
  double travelled = 0;  // m, the greatest that a node has moved
};

// 72 nodes, about 290 springs, in free flight from random velocities, dragged along by 3
// controllers on random ways.
Distance CompareWithOracle(const SpringMassSystem& system, bool controller_velocity,
                           int substeps = kSubsteps) {
  const int nodes = system.node_count();
  Random random(7);
  const Points start = system.position.leftCols(nodes) + random.Box(nodes, 0.01);
  const Points velocity = random.Box(nodes, 0.5);

  TendonOracle oracle(system, kGravity, kFrameTime / substeps);
  oracle.SetState(start, velocity);
  Environment environment;
  environment.gravity = kGravity;
  const Simulator<double> simulator(
      system, environment,
      {.frame_time = kFrameTime, .substeps = substeps, .controller_velocity = controller_velocity});
  Simulator<double>::Workspace workspace(simulator);
  NodeStates<double> state = simulator.MakeState(start, velocity);

  Distance distance;
  Points hands = system.position.rightCols(system.controllers);
  for (int frame = 0; frame < kFrames; ++frame) {
    const Points next = hands + random.Box(system.controllers, 0.02);
    simulator.AdvanceFrame({hands, next, {}}, &state, &workspace);
    for (int substep = 1; substep <= substeps; ++substep) {
      oracle.Step(hands + (next - hands) * (static_cast<double>(substep) / substeps));
    }
    hands = next;
    const Points difference = simulator.Positions(state) - oracle.Positions();
    const Points way = simulator.Positions(state) - start;
    distance.nodes = std::max(distance.nodes, difference.colwise().norm().maxCoeff());
    distance.travelled = std::max(distance.travelled, way.colwise().norm().maxCoeff());
  }
  return distance;
}

TEST(SimulatorMujoco, TrajectoryIsThatOfNativeTendons) {
  const SpringMassSystem system = RandomSystem(72, 3, 11);
  ASSERT_GE(system.spring_count(), 250);
  const Distance distance = CompareWithOracle(system, false);
  EXPECT_GT(distance.travelled, 0.05);
  // measured: 2e-13 m, rounding alone
  EXPECT_LT(distance.nodes, 1e-9);
}

TEST(SimulatorMujoco, StiffeningIsThatOfNativeTendons) {
  SpringMassSystem system = RandomSystem(72, 3, 11);
  const Distance without = CompareWithOracle(system, false);
  system.effects = {{"stiffening", Eigen::VectorXd::Constant(1, 3)}};
  const Distance with = CompareWithOracle(system, false);
  EXPECT_GT(std::abs(with.travelled - without.travelled), 1e-3);
  EXPECT_LT(with.nodes, 1e-9);
}

// MuJoCo lets the springs of mocap bodies pass the threshold by how far these move in a time step.
TEST(SimulatorMujoco, YieldApproachesThatOfNativeTendons) {
  SpringMassSystem system = RandomSystem(72, 3, 11);
  system.effects = {{"yield", Eigen::Vector2d(0, 0.1)}};
  const Distance coarse = CompareWithOracle(system, false, 100);
  const Distance fine = CompareWithOracle(system, false, 1000);
  EXPECT_LT(fine.nodes, 0.15 * coarse.nodes);
}

TEST(SimulatorMujoco, OracleFeelsNoControllerVelocity) {
  const Distance distance = CompareWithOracle(RandomSystem(72, 3, 11), true);
  EXPECT_GT(distance.nodes, 1e-6);
}

}  // namespace
}  // namespace physpring
