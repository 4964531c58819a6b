// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/neural_clasp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

constexpr double kTemperature = 0.4;

Eigen::VectorXd RandomDistances(const SpringMassSystem& system, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd distance(static_cast<Eigen::Index>(FreePairs(system).size()));
  for (double& d : distance) d = random(0.2, 2);
  return distance;
}

TEST(NeuralClasp, DrawsAsManyClustersAsAskedFor) {
  const SpringMassSystem system = RandomSystem(60, 2, 3);
  std::mt19937_64 random(4);
  for (int nodes : {60, 36, 20, 5}) {
    const Eigen::MatrixX2d scores = DrawScores(RandomDistances(system, 1), kTemperature, &random);
    EXPECT_EQ(CountClusters(ChooseClusters(system, scores, nodes).assignment),
              ClusterBudget(SpringGraph(system), nodes));
  }
}

TEST(NeuralClasp, TheGradientOfALogProbabilityIsItsDerivative) {
  const SpringMassSystem system = RandomSystem(40, 2, 5);
  Eigen::VectorXd distance = RandomDistances(system, 2);
  std::mt19937_64 random(6);
  const Choice choice = ChooseClusters(system, DrawScores(distance, kTemperature, &random), 22);
  const Eigen::VectorXd bar = LogProbabilityGradient(system, distance, choice, kTemperature);
  ASSERT_GT(bar.norm(), 0);
  std::vector<CheckedVariable> variables;
  for (int e = 0; e < distance.size(); ++e) {
    variables.push_back({std::to_string(e), &distance[e], 1e-3, bar[e]});
  }
  const auto value = [&] {
    return static_cast<long double>(LogProbability(system, distance, choice, kTemperature));
  };
  // the sum is made in double
  const GradientReport report = CheckGradient(value, variables, 1e-5);
  EXPECT_TRUE(report.passed) << report.log;
}

// Of two springs, a node takes the one of distance D with the probability of a softmax of -D.
TEST(NeuralClasp, DrawsByTheSoftmax) {
  const Eigen::Vector2d distance(0.3, 0.6);
  std::mt19937_64 random(7);
  constexpr int kDraws = 20000;
  int first = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::MatrixX2d scores = DrawScores(distance, kTemperature, &random);
    first += scores(0, 0) > scores(1, 0);
  }
  const double expected = 1 / (1 + std::exp((distance[0] - distance[1]) / kTemperature));
  const double deviation = std::sqrt(expected * (1 - expected) / kDraws);
  EXPECT_NEAR(static_cast<double>(first) / kDraws, expected, 4 * deviation);
}

}  // namespace
}  // namespace physpring
