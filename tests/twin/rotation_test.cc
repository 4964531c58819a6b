// SPDX-License-Identifier: Apache-2.0
#include "twin/rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace physpring {
namespace {

TEST(FitRotation, FindsTheRotationOfACloud) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 1, -3).normalized()).toRotationMatrix();
  const Points from = Points::Random(3, 12);
  EXPECT_LT((FitRotation(from, rotation * from) - rotation).norm(), 1e-4);
}

TEST(FitRotation, DoesNotTwistALine) {
  Points from(3, 2);
  from << 1, -2, 0, 0, 0, 0;
  const Eigen::Matrix3d rotation = FitRotation(from, Eigen::Vector3d(0, 1, 0) * from.row(0));
  const Eigen::Matrix3d expected =
      Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_LT((rotation - expected).norm(), 1e-4);
}

TEST(FitRotation, IsARotationOfThinClouds) {
  for (double thickness : {1e-1, 1e-3, 1e-6, 0.0}) {
    Points from = Points::Random(3, 12);
    from.row(2) *= thickness;
    const Eigen::Matrix3d rotation = FitRotation(from, from + 0.1 * Points::Random(3, 12));
    EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_GT(rotation.determinant(), 0);
  }
}

TEST(FitRotation, IsARotationEvenForAMirroredCloud) {
  const Points from = Points::Random(3, 12);
  EXPECT_NEAR(FitRotation(from, -from).determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace physpring
