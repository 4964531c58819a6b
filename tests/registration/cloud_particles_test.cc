// SPDX-License-Identifier: Apache-2.0
#include "registration/cloud_particles.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "twin/neighbours.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

TEST(CloudParticles, ColumnsOfNanAreNoPoints) {
  Points cloud = Points::Random(3, 4);
  cloud.col(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  const Points points = PointsOf(cloud);
  ASSERT_EQ(points.cols(), 3);
  EXPECT_EQ(points.col(0), cloud.col(0));
  EXPECT_EQ(points.col(1), cloud.col(2));
}

TEST(CloudParticles, FewPointsAreTheParticlesEachOnce) {
  Points cloud = Points::Random(3, 5);
  cloud.col(4) = cloud.col(1);
  const Points particles = SpreadParticles(cloud, 9);
  ASSERT_EQ(particles.cols(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(NeighbourSearch(particles).Nearest(cloud.col(i), 1)[0].distance, 0);
  }
}

TEST(CloudParticles, FarPointsAreOutliers) {
  Points cloud = Points::Random(3, 50);
  cloud.col(7) << 40, 0, 0;
  EXPECT_EQ(WithoutOutliers(cloud).cols(), 49);
  EXPECT_LT(WithoutOutliers(cloud).cwiseAbs().maxCoeff(), 1.0001);
}

// A square of which one quarter has four times as many points as the others.
TEST(CloudParticles, AreSpreadEvenlyOverAnUnevenCloud) {
  constexpr int kSparse = 600, kDense = 450, kParticles = 64;
  std::mt19937_64 generator(2);
  Points cloud = Points::Zero(3, kSparse + kDense);
  for (int i = 0; i < cloud.cols(); ++i) {
    const double side = i < kSparse ? 1 : 0.5;
    cloud(0, i) = side * Uniform(&generator);
    cloud(1, i) = side * Uniform(&generator);
  }
  const Points particles = SpreadParticles(cloud, kParticles);
  ASSERT_EQ(particles.cols(), kParticles);
  int in_quarter = 0;
  for (const auto& x : particles.colwise()) in_quarter += x[0] < 0.5 && x[1] < 0.5;
  EXPECT_NEAR(in_quarter, kParticles / 4.0, 6);
  const NeighbourSearch search(particles);
  for (int i = 0; i < kParticles; ++i) {
    EXPECT_GT(search.Nearest(particles.col(i), 2)[1].distance, 0.05);  // even: 1 / 8
  }
}

}  // namespace
}  // namespace physpring
