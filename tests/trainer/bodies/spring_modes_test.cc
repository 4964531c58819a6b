// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_modes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/simulation.h"

namespace physpring {
namespace {

// `chains` apart, each of `nodes` nodes along x.
SpringMassSystem Chains(int chains, int nodes) {
  Points position = Points::Zero(3, chains * nodes);
  for (int i = 0; i < position.cols(); ++i) {
    position(0, i) = 0.01 * (i % nodes);
    position(1, i) = i / nodes;
  }
  SpringMassSystem system = Particles(position, 0.01);
  for (int i = 0; i < position.cols(); ++i) {
    if (i % nodes > 0) AddSpring(i - 1, i, 10, 0.01, 0.1, &system);
  }
  return system;
}

// The modes of a path of N nodes are cos(pi m (i + 1/2) / N), with eigenvalues 2 - 2 cos(pi m / N)
// (Strang, The Discrete Cosine Transform, SIAM Review 41, 1999).
class ModesOfAChain : public testing::TestWithParam<int> {};

TEST_P(ModesOfAChain, AreCosines) {
  const int nodes = GetParam();
  const auto [modes, roughness] = SpringModes(Chains(1, nodes), 5);
  ASSERT_EQ(modes.rows(), nodes - 1);
  ASSERT_EQ(modes.cols(), 5);
  for (int m = 1; m <= 5; ++m) {
    Eigen::VectorXd expected(nodes - 1);
    for (int e = 0; e < nodes - 1; ++e) expected[e] = std::cos(M_PI * m * (e + 1) / nodes);
    expected /= std::sqrt(expected.squaredNorm() / (nodes - 1));
    EXPECT_LT((modes.col(m - 1) - expected).cwiseAbs().maxCoeff(), 1e-6) << m;
    const double rougher = (1 - std::cos(M_PI * m / nodes)) / (1 - std::cos(M_PI / nodes));
    EXPECT_NEAR(roughness[m - 1], rougher, 1e-6 * rougher) << m;
  }
}

// The shorter one is computed densely, the longer one by Lanczos' method.
INSTANTIATE_TEST_SUITE_P(Lengths, ModesOfAChain, testing::Values(20, 200));

TEST(SpringModes, AreAsManyAsThereAre) {
  EXPECT_EQ(SpringModes(Chains(1, 4), 8).fields.cols(), 3);
  EXPECT_EQ(SpringModes(Chains(1, 4), 0).fields.cols(), 0);
}

TEST(SpringModes, OfSeveralObjectsVaryWithinThem) {
  const Eigen::MatrixXd modes = SpringModes(Chains(3, 40), 3).fields;
  ASSERT_EQ(modes.cols(), 3);
  // the lowest ones of each chain: nearly 0 in the sum over any of them
  for (int m = 0; m < 3; ++m) {
    for (int chain = 0; chain < 3; ++chain) {
      EXPECT_LT(std::abs(modes.col(m).segment(39 * chain, 39).sum()), 1e-6) << m << " " << chain;
    }
  }
}

TEST(EvenSlopes, RiseAlongAChain) {
  const Eigen::MatrixXd slopes = EvenSlopes(Chains(1, 20));
  ASSERT_EQ(slopes.cols(), 1);
  const Eigen::VectorXd slope = slopes.col(0);
  EXPECT_NEAR(slope.squaredNorm() / slope.size(), 1, 1e-9);
  EXPECT_NEAR(slope.sum(), 0, 1e-9);
  EXPECT_GT(slope[0], 0);
  for (int e = 1; e < slope.size(); ++e) {
    EXPECT_NEAR(slope[e] - slope[e - 1], slope[1] - slope[0], 1e-9) << e;
  }
}

// Chains beside each other spread along x and y; only where they are long, y is no long direction.
TEST(EvenSlopes, AreAsManyAsLongDirections) {
  const auto count = [](double spacing) {
    SpringMassSystem chains = Chains(4, 20);
    chains.position.row(1) *= spacing;
    return EvenSlopes(chains).cols();
  };
  EXPECT_EQ(count(0.04), 2);
  EXPECT_EQ(count(0.003), 1);
}

}  // namespace
}  // namespace physpring
