// SPDX-License-Identifier: Apache-2.0
// A grasp that begins within a motion takes hold of the body as it is then.
#include "twin/grasp_springs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "trainer/motion/lane_rollout.h"
#include "trainer/motion/rollout.h"
#include "twin/environment.h"
#include "twin/grasps.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

// A rope that a hand swings at its upper end; a second hand takes the lower one in frame 9.
class CaughtRope : public testing::Test {
 protected:
  static constexpr int kParticles = 8, kFrames = 24, kCaught = 9;

  CaughtRope() : recording_(SwungRope(kParticles, kFrames)) {
    recording_.held.resize(kFrames, 2);
    recording_.held.setConstant(true);
    recording_.held.col(1).head(kCaught).setConstant(false);
    recording_.start.conservativeResize(3, kParticles + 2);
    recording_.start.col(kParticles + 1) << 0.003, 0.002, -0.01 * kParticles;
    recording_.rest = recording_.start;
    for (int t = 0; t < kFrames; ++t) {
      Points& hands = recording_.controllers[t];
      hands.conservativeResize(3, 2);
      hands.col(1) = recording_.start.col(kParticles + 1) +
                     Eigen::Vector3d(0.01, 0.02, 0.01) * std::sin(0.3 * t);
      recording_.points[t].row(1).array() += 0.001 * t;
    }
    FindShapesWhenHeld(&recording_);
    system_ = MakeStartSystem(recording_, {.max_neighbours = 4, .controller_max_neighbours = 3});
    ScaleToSubsteps(1 / recording_.fps, 20, 0.7, &system_);
    for (int e = 0; e < system_.spring_count(); ++e) system_.stiffness[e] *= 1 + 0.1 * (e % 3);
    system_.effects.push_back({"control_latency", Eigen::VectorXd::Constant(1, 0.3 / 30)});
  }

  RolloutOptions Options() const {
    RolloutOptions options;
    options.substeps = 30;
    return options;
  }

  Recording recording_;
  SpringMassSystem system_;
};

TEST_F(CaughtRope, IsHeldAsItIsThen) {
  const Simulator<double> simulator(
      system_, EnvironmentOf(recording_),
      {1 / recording_.fps, Options().substeps, true, LateGraspsOf(recording_)});
  Simulator<double>::Workspace workspace(simulator);
  auto state =
      simulator.MakeState(recording_.start.leftCols(kParticles), Points::Zero(3, kParticles));
  for (int t = 1; t < kFrames; ++t) {
    simulator.AdvanceFrame(RecordedInput(recording_, t, ControllerDelay(system_)), &state,
                           &workspace);
    EXPECT_EQ(simulator.RestLengths(state) == system_.rest_length, t <= kCaught);
  }
  const Eigen::VectorXd length = simulator.RestLengths(state);
  const Eigen::Vector3d hand = recording_.controllers[kCaught].col(1);
  int late = 0;
  for (int e = 0; e < system_.spring_count(); ++e) {
    const auto [node, end] = std::minmax(system_.springs[e][0], system_.springs[e][1]);
    const bool caught = end == kParticles + 1;
    late += caught ? 1 : 0;
    const Points& reference = system_.position;
    const double shift = (hand - recording_.points[kCaught].col(node)).norm() -
                         (reference.col(end) - reference.col(node)).norm();
    EXPECT_NEAR(length[e], system_.rest_length[e] + (caught ? shift : 0), 1e-15);
  }
  EXPECT_GT(late, 1);
}

TEST_F(CaughtRope, IsTheSameInLanes) {
  std::vector<SpringMassSystem> systems(5, system_);
  for (std::size_t i = 0; i < systems.size(); ++i) systems[i].stiffness *= 1 + 0.05 * i;
  const Episode episode{&recording_, kFrames};
  const auto together = RollOutSideBySide(systems, episode, Options());
  for (std::size_t i = 0; i < systems.size(); ++i) {
    ASSERT_TRUE(together[i].has_value());
    EXPECT_EQ(*together[i], RollOut(systems[i], episode, Options())->positions());
  }
}

// Against central differences.
TEST_F(CaughtRope, HasTheRightGradient) {
  const Episode episode{&recording_, kFrames};
  std::vector<Points> weights;
  for (int t = 0; t < kFrames; ++t) weights.emplace_back(Points::Random(3, kParticles));
  const auto loss = [&](const SpringMassSystem& system) {
    const auto rollout = RollOut(system, episode, Options());
    double sum = 0;
    for (int t = 0; t < kFrames; ++t) sum += weights[t].cwiseProduct(rollout->positions()[t]).sum();
    return sum;
  };
  const RolloutAdjoint adjoint = RollOut(system_, episode, Options())->Adjoint(weights);
  const auto check = [&](double found, double step, auto value, const std::string& what) {
    SpringMassSystem more = system_, less = system_;
    value(more) += step;
    value(less) -= step;
    const double expected = (loss(more) - loss(less)) / (2 * step);
    EXPECT_NEAR(found, expected, 1e-6 * std::abs(expected) + 1e-9) << what;
  };
  for (int e = 0; e < system_.spring_count(); ++e) {
    const std::string name = std::to_string(e);
    check(
        adjoint.gradient.stiffness[e], 1e-5 * system_.stiffness[e],
        [e](SpringMassSystem& s) -> double& { return s.stiffness[e]; }, "stiffness " + name);
    check(
        adjoint.gradient.dashpot[e], 1e-5 * system_.dashpot[e],
        [e](SpringMassSystem& s) -> double& { return s.dashpot[e]; }, "dashpot " + name);
    check(
        adjoint.gradient.rest_length[e], 1e-7 * system_.rest_length[e],
        [e](SpringMassSystem& s) -> double& { return s.rest_length[e]; }, "length " + name);
  }
  check(
      adjoint.gradient.effects[0][0], 1e-6,
      [](SpringMassSystem& s) -> double& { return s.effects[0].values[0]; }, "latency");
}

}  // namespace
}  // namespace physpring
