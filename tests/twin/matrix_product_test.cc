// SPDX-License-Identifier: Apache-2.0
// Sums of matrix products are cut into parts that fit Eigen's idea of the caches. It has to be the
// same on every machine: other parts are rounded otherwise (docs/decisions/119).
#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace physpring {
namespace {

TEST(MatrixProduct, IsNotCutToTheCachesOfThisProcessor) {
  EXPECT_EQ(Eigen::l1CacheSize(), 32 * 1024);
  EXPECT_EQ(Eigen::l2CacheSize(), 256 * 1024);
  EXPECT_EQ(Eigen::l3CacheSize(), 2 * 1024 * 1024);
}

}  // namespace
}  // namespace physpring
