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
// controllers on random ways. The nodes start up to `away` from where the system has them.
Distance CompareWithOracle(const SpringMassSystem& system, bool controller_velocity,
                           int substeps = kSubsteps, double away = 0.01) {
  const int nodes = system.node_count();
  Random random(7);
  const Points start = system.position.leftCols(nodes) + random.Box(nodes, away);
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

// Springs that yield, unstretched at the start: MuJoCo's plastic part moves after the first force.
class YieldMujoco : public testing::Test {
 protected:
  YieldMujoco() : system(RandomSystem(72, 3, 11)) {
    for (int e = 0; e < system.spring_count(); ++e) {
      const auto& [a, b] = system.springs[e];
      system.rest_length[e] = (system.position.col(a) - system.position.col(b)).norm();
    }
  }

  Distance Compare(int substeps, double lag) {
    system.effects = {{"yield", Eigen::Vector3d(0, 0.1, lag)}};
    return CompareWithOracle(system, false, substeps, 1e-9);
  }

  SpringMassSystem system;
};

// MuJoCo's springs of mocap bodies lag behind by a time step.
TEST_F(YieldMujoco, ApproachesThatOfNativeTendons) {
  EXPECT_LT(Compare(1000, 0).nodes, 0.25 * Compare(100, 0).nodes);
}

TEST_F(YieldMujoco, WithALagOfTheTimeStepIsThatOfNativeTendons) {
  // measured: 0.18 and 7.7 mm
  EXPECT_LT(Compare(100, kFrameTime / 100).nodes, 0.05 * Compare(100, 0).nodes);
}

TEST(SimulatorMujoco, OracleFeelsNoControllerVelocity) {
  const Distance distance = CompareWithOracle(RandomSystem(72, 3, 11), true);
  EXPECT_GT(distance.nodes, 1e-6);
}

}  // namespace
}  // namespace physpring
