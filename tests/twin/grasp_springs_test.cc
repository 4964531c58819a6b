// SPDX-License-Identifier: Apache-2.0
// A released controller moves nothing; a grasp that begins within a motion takes hold of the body
// as it is then.
#include "twin/grasp_springs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
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

// A rope held by a hand at either end; `held` says when the lower one holds.
class HeldRope : public testing::Test {
 protected:
  static constexpr int kParticles = 8, kFrames = 24;

  HeldRope() : recording_(SwungRope(kParticles, kFrames)) {
    recording_.held.resize(kFrames, 2);
    recording_.held.setConstant(true);
    recording_.start.conservativeResize(3, kParticles + 2);
    recording_.start.col(kParticles + 1) << 0.003, 0.002, -0.01 * kParticles;
    recording_.rest = recording_.start;
    for (Points& hands : recording_.controllers) {
      hands.conservativeResize(3, 2);
      hands.col(1) = recording_.start.col(kParticles + 1);
    }
    system_ = MakeStartSystem(recording_, {.max_neighbours = 4, .controller_max_neighbours = 3});
    ScaleToSubsteps(1 / recording_.fps, 20, 0.7, &system_);
    for (int e = 0; e < system_.spring_count(); ++e) system_.stiffness[e] *= 1 + 0.1 * (e % 3);
    for (int t = 0; t < kFrames; ++t) weights_.emplace_back(Points::Random(3, kParticles));
  }

  static RolloutOptions Options() {
    RolloutOptions options;
    options.substeps = 30;
    return options;
  }

  Episode All() const { return {&recording_, kFrames}; }

  double Loss(const SpringMassSystem& system) const {
    const auto rollout = RollOut(system, All(), Options());
    double sum = 0;
    for (int t = 0; t < kFrames; ++t) {
      sum += weights_[t].cwiseProduct(rollout->positions()[t]).sum();
    }
    return sum;
  }

  SystemGradient GradientOfLoss() const {
    return RollOut(system_, All(), Options())->Adjoint(weights_).gradient;
  }

  // Against central differences; `value` gives that of a system.
  void ExpectDerivative(double found, double step,
                        const std::function<double&(SpringMassSystem&)>& value,
                        const std::string& what) const {
    SpringMassSystem more = system_, less = system_;
    value(more) += step;
    value(less) -= step;
    const double expected = (Loss(more) - Loss(less)) / (2 * step);
    EXPECT_NEAR(found, expected, 1e-6 * std::abs(expected) + 1e-9) << what;
  }

  // With respect to the parameters of a spring; lengths act strongest.
  void ExpectDerivatives(const SystemGradient& gradient, int e) const {
    for (auto [values, found, part] :
         {std::tuple{&SpringMassSystem::stiffness, gradient.stiffness[e], 1e-5},
          std::tuple{&SpringMassSystem::dashpot, gradient.dashpot[e], 1e-5},
          std::tuple{&SpringMassSystem::rest_length, gradient.rest_length[e], 1e-7}}) {
      ExpectDerivative(
          found, part * (system_.*values)[e],
          [values, e](SpringMassSystem& s) -> double& { return (s.*values)[e]; },
          "spring " + std::to_string(e));
    }
  }

  void ExpectTheSameInLanes() const {
    std::vector<SpringMassSystem> systems(5, system_);
    for (std::size_t i = 0; i < systems.size(); ++i) systems[i].stiffness *= 1 + 0.05 * i;
    const auto together = RollOutSideBySide(systems, All(), Options());
    for (std::size_t i = 0; i < systems.size(); ++i) {
      ASSERT_TRUE(together[i].has_value());
      EXPECT_EQ(*together[i], RollOut(systems[i], All(), Options())->positions());
    }
  }

  Recording recording_;
  SpringMassSystem system_;
  std::vector<Points> weights_;  // of the positions in the loss
};

// The lower hand lets go and takes hold again.
class ReleasedRope : public HeldRope {
 protected:
  ReleasedRope() { recording_.held.block(6, 1, 9, 1).setConstant(false); }
};

TEST_F(ReleasedRope, MovesAsIfTheHandWereNotThere) {
  Recording without = recording_;
  without.held.resize(0, 0);
  SpringMassSystem free = system_;
  for (int e = 0; e < system_.spring_count(); ++e) {
    if (std::max(system_.springs[e][0], system_.springs[e][1]) == kParticles + 1) {
      free.stiffness[e] = free.dashpot[e] = 0;
    }
  }
  const Episode held{&recording_, kFrames};
  const auto whole = RollOut(system_, held, Options());
  // the released frames alone, from the state that both have when the hand opens
  recording_.held.col(1).setConstant(false);
  const Episode released{&recording_, kFrames}, absent{&without, kFrames};
  const auto open = RollOut(system_, released, Options());
  const auto gone = RollOut(free, absent, Options());
  EXPECT_EQ(open->positions(), gone->positions());
  EXPECT_NE(whole->positions()[4], open->positions()[4]);
}

TEST_F(ReleasedRope, IsTheSameInLanes) { ExpectTheSameInLanes(); }

TEST_F(ReleasedRope, HasTheRightGradient) {
  const SystemGradient gradient = GradientOfLoss();
  for (int e = 0; e < system_.spring_count(); ++e) {
    if (system_.IsControllerSpring(e)) ExpectDerivatives(gradient, e);
  }
}

// The same as a rod that both hands are part of.
class ReleasedRod : public ReleasedRope {
 protected:
  ReleasedRod() {
    RodEdges edges = {{kParticles, 0}};  // the upper hand
    for (int i = 0; i + 1 < kParticles; ++i) edges.push_back({i, i + 1});
    without_hand_ = RodOfEdges(edges, system_.position);
    edges.push_back({kParticles - 1, kParticles + 1});
    system_.rod = RodOfEdges(edges, system_.position);
    system_.effects = {{"bending", Eigen::VectorXd::Constant(1, 2e-6)},
                       {"bending_damping", Eigen::VectorXd::Constant(1, 1e-8)},
                       {"bending_friction", Eigen::Vector2d(1e-6, 1)}};
  }

  Rod without_hand_;
};

TEST_F(ReleasedRod, IsNotBentByTheHand) {
  recording_.held.col(1).setConstant(false);
  SpringMassSystem shorter = system_, straight = system_;
  shorter.rod = without_hand_;
  straight.effects.clear();
  const Points end = RollOut(system_, All(), Options())->positions().back();
  const auto apart = [&](const SpringMassSystem& other) {
    return (RollOut(other, All(), Options())->positions().back() - end).norm();
  };
  EXPECT_LT(apart(shorter), 1e-12);  // its triples are in another order
  EXPECT_GT(apart(straight), 1e-4);
}

TEST_F(ReleasedRod, IsNotTwistedByTheHand) {
  recording_.held.col(1).setConstant(false);
  SpringMassSystem untwisted = system_;
  system_.effects.push_back({"twist", Eigen::Vector2d(2e-5, 1)});
  EXPECT_EQ(RollOut(system_, All(), Options())->positions(),
            RollOut(untwisted, All(), Options())->positions());
  recording_.held.col(1).setConstant(true);
  EXPECT_NE(RollOut(system_, All(), Options())->positions(),
            RollOut(untwisted, All(), Options())->positions());
}

TEST_F(ReleasedRod, HasTheRightGradient) {
  system_.effects.pop_back();  // friction has kinks
  system_.effects.push_back({"twist", Eigen::Vector2d(2e-5, 1)});
  const SystemGradient gradient = GradientOfLoss();
  for (std::size_t i = 0; i < system_.effects.size(); ++i) {
    for (int j = 0; j < system_.effects[i].values.size(); ++j) {
      ExpectDerivative(
          gradient.effects[i][j], 1e-4 * system_.effects[i].values[j],
          [i, j](SpringMassSystem& s) -> double& { return s.effects[i].values[j]; },
          system_.effects[i].name);
    }
  }
}

TEST_F(ReleasedRod, IsTheSameInLanes) { ExpectTheSameInLanes(); }

// The upper hand swings it, the lower one takes it in frame 9.
class CaughtRope : public HeldRope {
 protected:
  static constexpr int kCaught = 9;

  CaughtRope() {
    recording_.held.col(1).head(kCaught).setConstant(false);
    for (int t = 0; t < kFrames; ++t) {
      recording_.controllers[t].col(1) += Eigen::Vector3d(0.01, 0.02, 0.01) * std::sin(0.3 * t);
      recording_.points[t].row(1).array() += 0.001 * t;
    }
    FindShapesWhenHeld(&recording_);
    system_.effects.push_back({"control_latency", Eigen::VectorXd::Constant(1, 0.3 / 30)});
  }
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

TEST_F(CaughtRope, IsTheSameInLanes) { ExpectTheSameInLanes(); }

TEST_F(CaughtRope, HasTheRightGradient) {
  const SystemGradient gradient = GradientOfLoss();
  for (int e = 0; e < system_.spring_count(); ++e) ExpectDerivatives(gradient, e);
  ExpectDerivative(
      gradient.effects[0][0], 1e-6,
      [](SpringMassSystem& s) -> double& { return s.effects[0].values[0]; }, "latency");
}

}  // namespace
}  // namespace physpring
