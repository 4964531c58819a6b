// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/cma_es.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "trainer/journal/packing.h"

namespace physpring {
namespace {

using Objective = std::function<double(const Eigen::VectorXd&)>;

std::vector<double> Values(const std::vector<Eigen::VectorXd>& points, const Objective& objective) {
  std::vector<double> values;
  for (const Eigen::VectorXd& point : points) values.push_back(objective(point));
  return values;
}

CmaEs Search(const Eigen::VectorXd& start, std::uint64_t seed, int generations,
             const Objective& objective) {
  CmaEs search(start, 0.2, seed);
  for (int i = 0; i < generations; ++i) search.Tell(Values(search.Ask(), objective));
  return search;
}

Eigen::VectorXd Constant(int n, double value) { return Eigen::VectorXd::Constant(n, value); }

double Sphere(const Eigen::VectorXd& x) { return (x.array() - 0.6).square().sum(); }

// Axes of lengths 1 to 1000.
double Ellipsoid(const Eigen::VectorXd& x) {
  double sum = 0;
  for (int i = 0; i < x.size(); ++i) {
    const double stretched = std::pow(1e3, i / (x.size() - 1.0)) * (x[i] - 0.4);
    sum += stretched * stretched;
  }
  return sum;
}

// On [-2, 2]^n, where the minimum is at (1, ..., 1): 0.75 in the cube.
double Rosenbrock(const Eigen::VectorXd& unit) {
  const Eigen::VectorXd x = 4 * unit.array() - 2;
  double sum = 0;
  for (int i = 0; i + 1 < x.size(); ++i) {
    sum += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
  }
  return sum;
}

// The generations leave room to spare.
TEST(CmaEs, FindsTheMinimumOfASphere) {
  const CmaEs search = Search(Constant(5, 0.3), 1, 150, Sphere);
  EXPECT_LT(search.state().best_objective, 1e-12);
  EXPECT_LT((search.state().best - Constant(5, 0.6)).norm(), 1e-6);
}

TEST(CmaEs, FindsTheMinimumOfALongEllipsoid) {
  const CmaEs search = Search(Constant(6, 0.7), 2, 500, Ellipsoid);
  EXPECT_LT((search.state().best - Constant(6, 0.4)).norm(), 1e-6);
}

TEST(CmaEs, FollowsRosenbrocksValley) {
  const CmaEs search = Search(Constant(4, 0.3), 3, 500, Rosenbrock);
  EXPECT_LT((search.state().best - Constant(4, 0.75)).norm(), 1e-5);
}

TEST(CmaEs, ReachesACornerOfTheCube) {
  const CmaEs search =
      Search(Constant(3, 0.5), 4, 100, [](const Eigen::VectorXd& x) { return x[0] - x[1] + x[2]; });
  EXPECT_LT((search.state().best - Eigen::Vector3d(0, 1, 0)).norm(), 1e-6);
}

TEST(CmaEs, KeepsEveryCandidateInTheCube) {
  const CmaEs search(Constant(4, 0.5), 10, 5, 1000);
  for (const Eigen::VectorXd& point : search.Ask()) {
    EXPECT_GE(point.minCoeff(), 0);
    EXPECT_LE(point.maxCoeff(), 1);
  }
}

TEST(CmaEs, DrawsNormallyAroundTheStart) {
  constexpr int kCount = 20000;
  constexpr double kStep = 0.05;
  const CmaEs search(Constant(1, 0.5), kStep, 6, kCount);
  double sum = 0, squares = 0, fourth_powers = 0;
  for (const Eigen::VectorXd& point : search.Ask()) {
    const double z = (point[0] - 0.5) / kStep;
    sum += z;
    squares += z * z;
    fourth_powers += z * z * z * z;
  }
  // moments of a normal deviate: 0, 1, 3, with variances 1, 2, 96 of one draw; 5 deviations
  const double deviation = 5 / std::sqrt(kCount);
  EXPECT_NEAR(sum / kCount, 0, deviation);
  EXPECT_NEAR(squares / kCount, 1, std::sqrt(2) * deviation);
  EXPECT_NEAR(fourth_powers / kCount, 3, std::sqrt(96) * deviation);
}

// Starts at the ends of the fold, too: what comes out is what went in.
TEST(CmaEs, DrawsAroundStartsNearTheEnds) {
  for (double start : {0.0, 0.02, 0.95, 1.0}) {
    const CmaEs search(Constant(2, start), 1e-9, 7);
    for (const Eigen::VectorXd& point : search.Ask()) {
      EXPECT_LT((point - Constant(2, start)).norm(), 1e-7) << start;
    }
  }
}

TEST(CmaEs, HasThePopulationOfTheTutorial) {
  EXPECT_EQ(CmaEs(Constant(12, 0.5), 0.2, 8).population(), 11);
  EXPECT_EQ(CmaEs(Constant(2, 0.5), 0.2, 8).population(), 6);
}

TEST(CmaEs, DependsOnNothingButSeedAndValues) {
  const CmaEs first = Search(Constant(4, 0.5), 9, 30, Rosenbrock);
  const CmaEs same = Search(Constant(4, 0.5), 9, 30, Rosenbrock);
  const CmaEs other = Search(Constant(4, 0.5), 10, 30, Rosenbrock);
  EXPECT_EQ(first.state().mean, same.state().mean);
  EXPECT_EQ(first.state().covariance, same.state().covariance);
  EXPECT_NE(first.state().mean, other.state().mean);
}

// Only the ranks of the candidates count.
TEST(CmaEs, IsUnmovedByAMonotoneChangeOfTheObjective) {
  const CmaEs plain = Search(Constant(4, 0.5), 11, 30, Rosenbrock);
  const CmaEs bent = Search(Constant(4, 0.5), 11, 30, [](const Eigen::VectorXd& x) {
    return std::log(1e-3 + Rosenbrock(x));
  });
  EXPECT_EQ(plain.state().mean, bent.state().mean);
}

TEST(CmaEs, GoesOnFromASavedState) {
  CmaEs whole = Search(Constant(4, 0.5), 12, 20, Rosenbrock);
  CmaEs resumed(Constant(4, 0.1), 1, 12);
  Unpack(Pack(Search(Constant(4, 0.5), 12, 13, Rosenbrock)), &resumed);
  for (int i = 13; i < 20; ++i) resumed.Tell(Values(resumed.Ask(), Rosenbrock));
  EXPECT_EQ(whole.Ask(), resumed.Ask());
  EXPECT_EQ(whole.state().best, resumed.state().best);
}

TEST(CmaEs, RanksWhatIsNoNumberLast) {
  const auto half = [](const Eigen::VectorXd& x) {
    return x[0] < 0.5 ? std::numeric_limits<double>::quiet_NaN() : Sphere(x);
  };
  const CmaEs search = Search(Constant(3, 0.5), 13, 80, half);
  EXPECT_LT((search.state().best - Constant(3, 0.6)).norm(), 1e-4);
}

}  // namespace
}  // namespace physpring
