// SPDX-License-Identifier: Apache-2.0
#include "twin/quiet_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace physpring {
namespace {

constexpr int kRows = 30, kColumns = 4;
constexpr double kSpacing = 0.02, kNoise = 1e-3;  // m

// A ribbon; `radius`: what it is bent to along its length, m.
Points Ribbon(double radius) {
  Points ribbon(3, kRows * kColumns);
  for (int i = 0; i < kRows; ++i) {
    const double angle = kSpacing * i / radius;
    for (int j = 0; j < kColumns; ++j) {
      ribbon.col(kColumns * i + j) << radius * std::sin(angle), kSpacing * j,
          radius * (1 - std::cos(angle));
    }
  }
  return ribbon;
}

Points WithNoise(Points shape) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, kNoise);
  for (double& x : shape.reshaped()) x += noise(random);
  return shape;
}

double RootMeanSquare(const Points& difference) { return std::sqrt(difference.cwiseAbs2().mean()); }

TEST(QuietShape, IsNearerToTheTruthThanWhatWasMeasured) {
  const Points from = Ribbon(1e3);
  for (double radius : {1.0, 0.2}) {
    const Points truth = Ribbon(radius);
    const Points quiet = QuietShape(from, WithNoise(truth), kNoise);
    EXPECT_LT(RootMeanSquare(quiet - truth), 0.65 * kNoise) << radius;
  }
}

TEST(QuietShape, KeepsWhatTheColumnsAroundDoNotTell) {
  const Points from = Ribbon(1e3), measured = WithNoise(Ribbon(0.02));  // rolled up
  EXPECT_LT(RootMeanSquare(QuietShape(from, measured, kNoise) - measured), 0.3 * kNoise);
}

// A motion that is rough from frame to frame looks like noise.
TEST(QuietShape, KnowsNoiseThatIsLessThanItIsTold) {
  const Points from = Ribbon(1e3), truth = Ribbon(1), measured = WithNoise(truth);
  const Points quiet = QuietShape(from, measured, kNoise);
  EXPECT_LT((QuietShape(from, measured, 5 * kNoise) - quiet).norm(),
            0.1 * (quiet - measured).norm());
  EXPECT_EQ(QuietShape(from, from, kNoise), from);
}

TEST(QuietShape, IsWhatWasMeasuredWithoutNoise) {
  const Points measured = WithNoise(Ribbon(0.2));
  EXPECT_EQ(QuietShape(Ribbon(1e3), measured, 0), measured);
  const Points few = measured.leftCols(4);  // which nothing can be left out of
  EXPECT_EQ(QuietShape(Ribbon(1e3).leftCols(4), few, kNoise), few);
}

TEST(QuietShape, LeavesOutWhatIsNotSeen) {
  const Points truth = Ribbon(0.2);
  Points measured = WithNoise(truth);
  measured.col(17).setConstant(std::nan(""));
  Points from = Ribbon(1e3);
  from.col(40).setConstant(std::nan(""));
  const Points quiet = QuietShape(from, measured, kNoise);
  EXPECT_TRUE(quiet.col(17).array().isNaN().all());
  EXPECT_EQ(quiet.col(40), measured.col(40));
  EXPECT_LT((quiet.col(18) - truth.col(18)).norm(), 3 * kNoise);
}

}  // namespace
}  // namespace physpring
