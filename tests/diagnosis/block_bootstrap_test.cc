// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/block_bootstrap.h"

#include <gtest/gtest.h>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

// Share of 200 series of zero mean, alike within runs of five frames, that look better than chance.
double FalseAlarms(double level) {
  Random random(3);
  int alarms = 0;
  constexpr int kSeries = 200;
  for (int series = 0; series < kSeries; ++series) {
    std::vector<double> difference;
    for (int run = 0; run < 40; ++run) {
      const double value = random(-1, 1);
      difference.insert(difference.end(), 5, value);
    }
    if (BlockBootstrap(difference, 10, 500, 1).p < level) ++alarms;
  }
  return static_cast<double>(alarms) / kSeries;
}

TEST(BlockBootstrap, RarelyTakesChanceForGain) {
  EXPECT_LT(FalseAlarms(0.05), 0.12);
  EXPECT_LT(FalseAlarms(0.01), 0.05);
}

TEST(BlockBootstrap, SeesAGain) {
  Random random(4);
  std::vector<double> difference;
  for (int i = 0; i < 200; ++i) difference.push_back(random(-1, 1) + 0.5);
  const BootstrapResult result = BlockBootstrap(difference, 10, 1000, 1);
  EXPECT_LT(result.p, 0.002);
  EXPECT_LT(result.low, result.mean);
  EXPECT_GT(result.low, 0.3);
  EXPECT_GT(result.high, result.mean);
}

TEST(BlockBootstrap, IsUnsureOfAFewFrames) {
  const BootstrapResult result = BlockBootstrap({-1, 1, 2, 3, 2, 1}, 10, 1000, 1);
  EXPECT_LT(result.low, result.mean - 0.5);  // one block of all would have no width
  EXPECT_GT(result.high, result.mean + 0.5);
}

TEST(BlockBootstrap, SaysNothingWithoutFrames) { EXPECT_EQ(BlockBootstrap({}, 10, 1000, 1).p, 1); }

}  // namespace
}  // namespace physpring
