// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/adam.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

TEST(Adam, FirstStepIsAsLongAsTheRateWhateverTheGradient) {
  Adam adam(3);
  Eigen::VectorXd x = Eigen::Vector3d(1, 2, 3);
  adam.Step(Eigen::Vector3d(1e-3, -5, 1e4), Eigen::Vector3d(0.1, 0.2, 0.3), &x);
  EXPECT_LT((x - Eigen::Vector3d(0.9, 2.2, 2.7)).norm(), 1e-8);
}

TEST(Adam, EntryWithoutGradientDoesNotMove) {
  Adam adam(2);
  Eigen::VectorXd x = Eigen::Vector2d(0.7, 0.7);
  for (int i = 0; i < 5; ++i) adam.Step(Eigen::Vector2d(0, 1), Eigen::Vector2d(0.1, 0.1), &x);
  EXPECT_EQ(x[0], 0.7);
  EXPECT_NEAR(x[1], 0.7 - 5 * 0.1, 1e-9);  // a constant gradient keeps the step's length
}

// mean = 0.9 * 0.1 * 2 + 0.1 * (-1), mean square = 0.99 * 0.01 * 4 + 0.01 * 1
TEST(Adam, SecondStepFollowsTheBiasCorrectedMeans) {
  Adam adam(1);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
  const Eigen::VectorXd rate = Eigen::VectorXd::Constant(1, 0.5);
  adam.Step(Eigen::VectorXd::Constant(1, 2), rate, &x);
  adam.Step(Eigen::VectorXd::Constant(1, -1), rate, &x);
  const double second = 0.5 * (0.08 / 0.19) / std::sqrt(0.0496 / 0.0199);
  EXPECT_NEAR(x[0], -0.5 - second, 1e-9);
}

}  // namespace
}  // namespace physpring
