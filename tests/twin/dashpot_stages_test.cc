// SPDX-License-Identifier: Apache-2.0
// Dashpots in stages against closed forms, against short sub-steps and against differences.
#include "twin/dashpot_stages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/lanes.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "tests/support/targeted_rollout.h"
#include "twin/kernel_choice.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// T_s by its closed forms.
double Chebyshev(int s, double y) {
  if (std::abs(y) <= 1) return std::cos(s * std::acos(y));
  return (y < -1 && s % 2 != 0 ? -1 : 1) * std::cosh(s * std::acosh(std::abs(y)));
}

double Slope(int s, double y) {
  return s * std::sinh(s * std::acosh(y)) / std::sinh(std::acosh(y));
}

// P(z), which a sub-step leaves of the velocity of a mode with h gamma = z.
double Damped(int s, double z) {
  const double w0 = 1 + 1.0 / (s * s), w1 = Chebyshev(s, w0) / Slope(s, w0);
  return Chebyshev(s, w0 - w1 * z) / Chebyshev(s, w0);
}

// Two masses on a spring, as in simulator_test.cc.
SpringMassSystem Oscillator(double omega, double gamma, int stages) {
  Points position(3, 2);
  position << 0.1, 0.21, 0.2, 0.2, 0.3, 0.3;
  SpringMassSystem system = Particles(position, 1);
  system.mass = Eigen::Vector2d(0.2, 0.3);
  const double reduced = 0.2 * 0.3 / 0.5;
  AddSpring(0, 1, reduced * omega * omega, 0.1, reduced * gamma, &system);
  system.dashpot_stages = stages;
  return system;
}

// u' = P(z) u - h omega^2 Q(z) s,  s' = s + h u',  Q(z) = (1 - P(z)) / z
TEST(DashpotStages, DampAModeByChebyshevsPolynomial) {
  constexpr double kStep = 0.01, kOmega = 20;
  for (int stages = 2; stages <= kMostDashpotStages; ++stages) {
    for (double share : {0.01, 0.3, 0.99}) {
      const double z = share * LimitsOfStages(stages).damping, damped = Damped(stages, z);
      Simulation simulation(Oscillator(kOmega, z / kStep, stages), Weightless(), kStep);
      double stretch = 0.01, speed = 0;
      for (int step = 1; step <= 300; ++step) {
        simulation.Advance(1);
        speed = damped * speed - kStep * kOmega * kOmega * (1 - damped) / z * stretch;
        stretch += kStep * speed;
        const Points x = simulation.position();
        ASSERT_NEAR((x.col(1) - x.col(0)).norm() - 0.1, stretch, 1e-13) << stages << " " << share;
      }
    }
  }
}

// A free network of RandomSystem that is damped so many times as strongly.
SpringMassSystem DampedNetwork(double times, int stages) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  system.drag = 0;
  system.dashpot *= times;
  system.dashpot_stages = stages;
  return system;
}

Points Moved(const SpringMassSystem& system, double h, int substeps) {
  Simulation simulation(system, Weightless(), h, substeps);
  simulation.SetVelocity(Random(3).Box(40, 0.1));
  simulation.Advance(1);
  return simulation.position();
}

TEST(DashpotStages, MoveAsShortSubstepsDo) {
  constexpr double kTime = 0.2;
  const SpringMassSystem one = DampedNetwork(100, 1), several = DampedNetwork(100, 6);
  const int many = StableSubsteps(ComputeStabilityBound(one), kTime, 0.1);
  const int few = StableSubsteps(ComputeStabilityBound(several), kTime, 0.3);
  ASSERT_LT(10 * few, many);
  const Points exact = Moved(one, kTime / many, many);
  const double way = (exact - one.position).cwiseAbs().maxCoeff();
  const double error = (Moved(several, kTime / few, few) - exact).cwiseAbs().maxCoeff();
  EXPECT_LT(error, 0.05 * way);
  // first order
  const double finer = (Moved(several, kTime / few / 4, 4 * few) - exact).cwiseAbs().maxCoeff();
  EXPECT_LT(finer, 0.35 * error);
}

TEST(DashpotStages, OneStageIsThePlainSubstep) {
  const DashpotStages<double> one(1);
  EXPECT_EQ(one.count(), 1);
  EXPECT_EQ(one.stage(0).take, 1);
  EXPECT_EQ(one.stage(0).kick, 1);
}

TEST(DashpotStages, KeepMomentum) {
  const SpringMassSystem system = DampedNetwork(100, 5);
  Simulation simulation(system, Weightless(), 0.9 * ComputeStabilityBound(system).timestep, 300);
  const Points start = Random(3).Box(40, 0.1);
  simulation.SetVelocity(start);
  simulation.Advance(1);
  const double size = start.colwise().norm() * system.mass;
  EXPECT_LT((simulation.velocity() * system.mass - start * system.mass).norm(), 1e-12 * size);
}

TEST(DashpotStages, AreStableBelowTheBound) {
  for (int stages : {2, 3, 8}) {
    for (double times : {1.0, 30.0, 1000.0}) {
      const SpringMassSystem system = DampedNetwork(times, stages);
      const double h = ComputeStabilityBound(system).timestep;
      const Points moved = Moved(system, 0.99 * h, 5000);
      EXPECT_LT((moved - system.position).cwiseAbs().maxCoeff(), 100 * h * 5000) << times;
    }
  }
}

TEST(DashpotStages, ExplodeAboveTheBound) {
  constexpr double kStep = 0.01;
  for (int stages : {2, 3, 8}) {
    const double gamma = 1.2 * LimitsOfStages(stages).damping / kStep;
    Simulation simulation(Oscillator(20, gamma, stages), Weightless(), kStep, 300);
    simulation.Advance(1);
    const double stretch = (simulation.position().col(1) - simulation.position().col(0)).norm();
    EXPECT_FALSE(stretch < 10) << stages;
  }
}

TEST(DashpotStages, LetDampedBodiesTakeLongerSubsteps) {
  const StabilityBound bound = ComputeStabilityBound(DampedNetwork(1000, 8));
  for (int stages = 2; stages <= kMostDashpotStages; ++stages) {
    EXPECT_GT(bound.TimestepOf(stages), 1.2 * bound.TimestepOf(stages - 1));
  }
  EXPECT_GT(bound.TimestepOf(8), 30 * bound.TimestepOf(1));
}

TEST(CutFrames, TakesSoManyStagesAsCostLeast) {
  SpringMassSystem system = DampedNetwork(1000, 1);
  const FrameCut plain = CutFrames(0.1, 0, system);
  EXPECT_EQ(plain.dashpot_stages, 1);
  system.dashpot_stages = kMostDashpotStages;
  const FrameCut cut = CutFrames(0.1, 0, system);
  EXPECT_GT(cut.dashpot_stages, 3);
  EXPECT_LT(cut.substeps * cut.dashpot_stages, plain.substeps / 4);
  // hardly damped: one is enough
  system.dashpot *= 1e-6;
  EXPECT_EQ(CutFrames(0.1, 0, system).dashpot_stages, 1);
}

TEST(CutFrames, TakesTheFewestStagesForGivenSubsteps) {
  SpringMassSystem system = DampedNetwork(1000, 8);
  const StabilityBound bound = ComputeStabilityBound(system);
  const int given = StableSubsteps(bound.TimestepOf(4), 0.1, kStepSafety);
  EXPECT_EQ(CutFrames(0.1, given, system).substeps, given);
  EXPECT_EQ(CutFrames(0.1, given, system).dashpot_stages, 4);
  EXPECT_EQ(CutFrames(0.1, 1, system).dashpot_stages, 8);  // too few, whatever it takes
}

TEST(LimitDashpots, LeavesMoreToStages) {
  SpringMassSystem one = DampedNetwork(1000, 1), several = DampedNetwork(1000, 8);
  SpringMassSystem undamped = one;
  undamped.dashpot.setZero();
  const double step = 0.2 * ComputeStabilityBound(undamped).timestep;
  EXPECT_TRUE(LimitDashpots(step, &one));
  EXPECT_TRUE(LimitDashpots(step, &several));
  EXPECT_GT(several.dashpot[0], 2 * one.dashpot[0]);
  EXPECT_NEAR(ComputeStabilityBound(several).CheapestTimestep(8), step, 1e-5 * step);
}

TEST(SoftenStiffNodes, MakesTheStepStableWithStages) {
  SpringMassSystem system = DampedNetwork(1000, 4);
  const double step = 3 * ComputeStabilityBound(system).timestep;
  SoftenStiffNodes(step, &system);
  EXPECT_GE(ComputeStabilityBound(system).timestep, step);
}

TargetedRollout StagedRollout(int stages) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.system.dashpot *= 20;
  rollout.system.dashpot_stages = stages;
  rollout.environment.gravity = Eigen::Vector3d(1, -2, -9.81);
  return rollout;
}

TEST(DashpotStages, GradientsMatchDifferences) {
  for (int stages : {2, 3, 5}) {
    for (const GradientReport& report : CheckRollout(StagedRollout(stages), 1e-3)) {
      EXPECT_TRUE(report.passed) << stages << ": " << report.log;
    }
  }
}

TEST(DashpotStages, GradientsMatchDifferencesWithEffects) {
  TargetedRollout rollout = StagedRollout(3);
  rollout.system.effects = {{"viscoelastic", Eigen::Vector2d(0.5, 0.02)},
                            {"air_drag", Eigen::Vector4d(0.3, 1, -2, 0.5)}};
  for (const GradientReport& report : CheckRollout(rollout, 1e-3)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

TEST(DashpotStages, GradientsMatchDifferencesOnTheGround) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.system.dashpot_stages = 3;
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.085);
  rollout.velocity.row(2).array() -= 1;
  for (const GradientReport& report : CheckRollout(rollout, 1e-5)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

TEST(DashpotStages, OfEachKernelGiveTheSameBits) {
  const SpringMassSystem system = StagedRollout(4).system;
  std::vector<NodeStates<float>> ends;
  for (std::string_view name : kKernelNames) {
    const Kernel<float>* kernel = FindKernel<float>(name);
    if (kernel == nullptr) continue;
    const Simulator<float> simulator(system, Weightless(), {.frame_time = 0.1, .substeps = 100},
                                     *kernel);
    Simulator<float>::Workspace workspace(simulator);
    const int nodes = system.node_count();
    NodeStates<float> state =
        simulator.MakeState(system.position.leftCols(nodes), Random(3).Box(nodes, 0.1));
    const Points hands = system.position.rightCols(system.controllers);
    simulator.AdvanceFrame({hands, hands, {}}, &state, &workspace);
    ends.push_back(state);
  }
  for (const NodeStates<float>& end : ends) {
    for (std::size_t i = 0; i < end.size(); ++i) {
      for (int j = 0; j < 3; ++j) ASSERT_EQ(end[i].x[j], ends[0][i].x[j]);
    }
  }
}

TEST(DashpotStages, GiveTheSameBitsSideBySide) {
  if (!HasLanes()) GTEST_SKIP() << "this processor has no AVX2";
  std::vector<TargetedRollout> all(11, StagedRollout(4));
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].system.dashpot *= 1 + 0.05 * static_cast<double>(i);
    all[i].system.mass *= 1 + 0.02 * static_cast<double>(i);
    all[i].system.drag = 0.3 * static_cast<double>(i);
  }
  EXPECT_EQ(DifferenceSideBySide(all), "");
}

}  // namespace
}  // namespace physpring
