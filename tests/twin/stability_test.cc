// SPDX-License-Identifier: Apache-2.0
#include "twin/stability.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "tests/support/random_system.h"
#include "tests/support/simulation.h"

namespace physpring {
namespace {

// n nodes in a row along x, joined to their neighbours, all springs at rest.
SpringMassSystem Row(int n, double stiffness, double dashpot) {
  Points position = Points::Zero(3, n);
  for (int i = 0; i < n; ++i) position(0, i) = 0.1 * i;
  SpringMassSystem system = Particles(position, 0.02);
  for (int i = 1; i < n; ++i) AddSpring(i - 1, i, stiffness, 0.1, dashpot, &system);
  return system;
}

// The exact eigenvalue, by Eigen.
double LargestEigenvalue(const SpringMassSystem& system, const Eigen::VectorXd& weight) {
  const int nodes = system.node_count();
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(nodes, nodes);
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    laplacian(a, a) += weight[e];
    if (b >= nodes) continue;
    laplacian(b, b) += weight[e];
    laplacian(a, b) -= weight[e];
    laplacian(b, a) -= weight[e];
  }
  const Eigen::VectorXd root = system.mass.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = root.asDiagonal() * laplacian * root.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

// From above, within 0.1 %.
void ExpectBoundsEigenvalues(const SpringMassSystem& system) {
  const StabilityBound bound = ComputeStabilityBound(system);
  const double omega = std::sqrt(LargestEigenvalue(system, system.stiffness));
  EXPECT_GE(bound.omega_max, omega * (1 - 1e-9));
  EXPECT_LE(bound.omega_max, omega * 1.001);
  const double gamma = LargestEigenvalue(system, system.dashpot);
  EXPECT_GE(bound.gamma_max, gamma * (1 - 1e-9));
  EXPECT_LE(bound.gamma_max, gamma * 1.002);
  EXPECT_NEAR(std::pow(bound.timestep * bound.omega_max, 2) + 2 * bound.timestep * bound.gamma_max,
              4, 1e-12);
}

TEST(Stability, BoundsTheEigenvaluesOfNetworks) {
  for (int seed = 0; seed < 20; ++seed) ExpectBoundsEigenvalues(RandomSystem(60, 3, seed));
}

// The eigenvalues at the end of the spectrum of a row lie close together.
TEST(Stability, BoundsTheEigenvaluesOfRows) {
  for (int n : {2, 3, 10, 100, 400}) ExpectBoundsEigenvalues(Row(n, 50, 0.3));
}

// Few of many nodes have a say in the largest eigenvalue.
TEST(Stability, FindsOneStiffSpringInALargeNetwork) {
  for (double factor : {1.5, 2.0, 10.0, 1000.0}) {
    SpringMassSystem system = RandomSystem(400, 0, 1);
    system.stiffness.setConstant(30);
    system.dashpot.setConstant(0.1);
    system.mass.setConstant(0.02);
    system.stiffness[777] *= factor;
    system.dashpot[777] *= factor;
    ExpectBoundsEigenvalues(system);
  }
}

TEST(Stability, OfOneMassOnASpringIsTwoOverOmega) {
  SpringMassSystem system = Row(2, 80, 0);
  system.controllers = 1;
  system.mass = Eigen::VectorXd::Constant(1, 0.05);
  system.contact_radius = Eigen::VectorXd::Zero(1);
  const StabilityBound bound = ComputeStabilityBound(system);
  EXPECT_NEAR(bound.omega_max, 40, 1e-9);
  EXPECT_NEAR(bound.timestep, 2.0 / 40, 1e-9);
}

// Largest motion of a row after `steps` of `h`, started by a push of 1 um/s.
double Growth(const SpringMassSystem& system, double h, int steps) {
  Simulation simulation(system, Weightless(), h, steps);
  Points velocity = Points::Zero(3, system.node_count());
  velocity.row(0) = 1e-6 * Random(1).Box(system.node_count(), 1).row(0);
  simulation.SetVelocity(velocity);
  simulation.Advance(1);
  return simulation.velocity().cwiseAbs().maxCoeff() / 1e-6;
}

TEST(Stability, TheBoundIsWhereARowBeginsToExplode) {
  for (double dashpot : {0.0, 0.05, 0.3}) {
    const SpringMassSystem system = Row(12, 50, dashpot);
    const double h = ComputeStabilityBound(system).timestep;
    EXPECT_LT(Growth(system, 0.995 * h, 2000), 100) << dashpot;
    EXPECT_GT(Growth(system, 1.005 * h, 2000), 1e6) << dashpot;
  }
}

TEST(Stability, ANetworkIsStableBelowTheBound) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  system.drag = 0;
  const double h = ComputeStabilityBound(system).timestep;
  Simulation simulation(system, Weightless(), 0.99 * h, 5000);
  simulation.SetVelocity(Random(3).Box(40, 0.1));
  simulation.Advance(1);
  EXPECT_LT(simulation.velocity().cwiseAbs().maxCoeff(), 1);
}

TEST(Stability, SpringsOfStiffnessZeroBoundNothing) {
  EXPECT_EQ(ComputeStabilityBound(Row(5, 0, 0)).timestep, std::numeric_limits<double>::infinity());
  EXPECT_EQ(StableSubsteps(ComputeStabilityBound(Row(5, 0, 0)), 0.1, 0.5), 1);
}

TEST(LimitDashpots, LowersThemToWhatTheStepAllows) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  const SpringMassSystem before = system;
  const double without = [&] {
    SpringMassSystem undamped = before;
    undamped.dashpot.setZero();
    return ComputeStabilityBound(undamped).timestep;
  }();
  const double step = 0.9 * without;
  ASSERT_GT(step, ComputeStabilityBound(before).timestep);
  EXPECT_TRUE(LimitDashpots(step, &system));
  EXPECT_NEAR(ComputeStabilityBound(system).timestep, step, 1e-5 * step);
  EXPECT_EQ(system.stiffness, before.stiffness);
  const double factor = system.dashpot[0] / before.dashpot[0];
  EXPECT_LT((system.dashpot - factor * before.dashpot).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(LimitDashpots, LeavesWhatIsStable) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  const Eigen::VectorXd before = system.dashpot;
  EXPECT_TRUE(LimitDashpots(ComputeStabilityBound(system).timestep, &system));
  EXPECT_EQ(system.dashpot, before);
}

TEST(LimitDashpots, SaysWhereSpringsAloneAreTooStiff) {
  SpringMassSystem system = Row(12, 50, 0.1);
  SpringMassSystem undamped = Row(12, 50, 0);
  EXPECT_FALSE(LimitDashpots(1.1 * ComputeStabilityBound(undamped).timestep, &system));
}

TEST(SoftenStiffNodes, MakesTheStepStableAndLeavesOtherSprings) {
  SpringMassSystem system = RandomSystem(40, 0, 2);
  const double step = 0.5 * ComputeStabilityBound(system).timestep;
  system.mass[7] *= 1e-3;  // a light node between others
  const SpringMassSystem before = system;
  ASSERT_LT(ComputeStabilityBound(system).timestep, step);
  SoftenStiffNodes(step, &system);
  EXPECT_GE(ComputeStabilityBound(system).timestep, step);
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    if (a == 7 || b == 7) {
      EXPECT_LT(system.stiffness[e], before.stiffness[e]);
      EXPECT_LT(system.dashpot[e], before.dashpot[e]);
    } else {
      EXPECT_EQ(system.stiffness[e], before.stiffness[e]);
    }
  }
}

TEST(Stability, SubstepsAreTheFewestBelowTheBound) {
  const StabilityBound bound{.timestep = 0.004};
  EXPECT_EQ(StableSubsteps(bound, 0.02, 1), 5);
  EXPECT_EQ(StableSubsteps(bound, 0.02, 0.5), 10);
  EXPECT_EQ(StableSubsteps(bound, 0.0201, 1), 6);
  EXPECT_EQ(StableSubsteps(bound, 0.001, 1), 1);
}

}  // namespace
}  // namespace physpring
