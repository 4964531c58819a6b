// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_radius.h"

#include <gtest/gtest.h>

#include <random>

namespace physpring {
namespace {

// A cubic grid of n^3 points, `spacing` apart, each moved by up to `noise` along each axis.
Points Grid(int n, double spacing, double noise) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> offset(-noise, noise);
  Points points(3, n * n * n);
  for (int i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3i place(i % n, i / n % n, i / (n * n));
    points.col(i) = spacing * place.cast<double>() +
                    Eigen::Vector3d::NullaryExpr([&] { return offset(random); });
  }
  return points;
}

// Shells of a cubic grid: 6 neighbours at 1, 18 within sqrt 2, 26 within sqrt 3, 32 within 2.
TEST(SpringRadius, LiesBetweenTheShellsOfAGrid) {
  for (const double noise : {0.0, 0.0002}) {
    const Points grid = Grid(7, 0.02, noise);
    EXPECT_GT(SpringRadius(grid, 18), 0.02 * std::sqrt(2.0) + noise);
    EXPECT_LT(SpringRadius(grid, 18), 0.02 * std::sqrt(3.0) - noise);
    EXPECT_GT(SpringRadius(grid, 6), 0.02 + noise);
    EXPECT_LT(SpringRadius(grid, 6), 0.02 * std::sqrt(2.0) - noise);
  }
}

TEST(SpringRadius, IsFoundForTwoPoints) {
  Points two = Points::Zero(3, 2);
  two(0, 1) = 0.1;
  EXPECT_GT(SpringRadius(two, 1), 0.1);
  EXPECT_LT(SpringRadius(two, 1), 0.11);
}

TEST(SpringRadius, GrowsWithTheScaleOfTheBody) {
  const Points grid = Grid(5, 0.01, 0.002);
  EXPECT_NEAR(SpringRadius(100 * grid, 20), 100 * SpringRadius(grid, 20), 1e-9);
}

}  // namespace
}  // namespace physpring
