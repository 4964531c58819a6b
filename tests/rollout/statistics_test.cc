// SPDX-License-Identifier: Apache-2.0
#include "rollout/statistics.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

TEST(WilsonInterval, IsThatOfATextbook) {
  // Agresti and Coull 1998: 8 of 10 gives 0.490 to 0.943
  const Interval interval = WilsonInterval(8, 10);
  EXPECT_NEAR(interval.low, 0.490, 5e-4);
  EXPECT_NEAR(interval.high, 0.943, 5e-4);
}

TEST(WilsonInterval, StaysWithinZeroAndOne) {
  EXPECT_EQ(WilsonInterval(0, 20).low, 0);
  EXPECT_NEAR(WilsonInterval(20, 20).high, 1, 1e-15);
  EXPECT_NEAR(WilsonInterval(0, 20).high, 0.1611, 5e-5);  // z^2 / (n + z^2)
}

TEST(PairedVerdicts, HaveCohensKappa) {
  // Cohen's own kind of example: 20 yes-yes, 5 yes-no, 10 no-yes, 15 no-no; agreement 0.7, by
  // chance 0.5, so kappa 0.4
  const PairedVerdicts verdicts{20, 5, 10, 15};
  EXPECT_NEAR(verdicts.Agreement(), 0.7, 1e-15);
  EXPECT_NEAR(verdicts.Kappa().value(), 0.4, 1e-12);
}

TEST(PairedVerdicts, HaveNoKappaWhereAllSucceed) {
  EXPECT_FALSE((PairedVerdicts{30, 0, 0, 0}).Kappa().has_value());
}

TEST(PairedVerdicts, AreTestedAsACoin) {
  // 1 of 10 discordant one way: 2 (1 + 10) / 2^10
  EXPECT_NEAR((PairedVerdicts{50, 1, 9, 40}).McNemar(), 22.0 / 1024, 1e-12);
  EXPECT_EQ((PairedVerdicts{50, 5, 5, 40}).McNemar(), 1);
  EXPECT_EQ((PairedVerdicts{50, 0, 0, 40}).McNemar(), 1);
}

TEST(Pearson, IsOneForALineAndMinusOneForAFallingOne) {
  EXPECT_NEAR(Pearson({0.1, 0.4, 0.7}, {0.3, 0.5, 0.7}).value(), 1, 1e-12);
  EXPECT_NEAR(Pearson({0.1, 0.4, 0.7}, {0.7, 0.5, 0.3}).value(), -1, 1e-12);
}

TEST(Pearson, IsNothingForConstantRates) {
  EXPECT_FALSE(Pearson({0.1, 0.4}, {0.5, 0.5}).has_value());
  EXPECT_FALSE(Pearson({0.1}, {0.5}).has_value());
}

TEST(MeanMaximumRankViolation, IsZeroWhereBothOrderAlike) {
  EXPECT_EQ(MeanMaximumRankViolation({0.2, 0.5, 0.9}, {0.1, 0.2, 0.3}), 0);
}

TEST(MeanMaximumRankViolation, CountsTheWorstSwapOfEachPolicy) {
  // the second and third are swapped, 0.4 apart; the first is in its place
  EXPECT_NEAR(MeanMaximumRankViolation({0.2, 0.5, 0.9}, {0.1, 0.8, 0.3}), (0 + 0.4 + 0.4) / 3,
              1e-12);
}

}  // namespace
}  // namespace physpring
