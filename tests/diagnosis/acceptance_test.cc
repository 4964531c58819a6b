// SPDX-License-Identifier: Apache-2.0
// The rules of a diagnosis, with numbers alone. Errors in mm.
#include "diagnosis/acceptance.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/random_system.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

// Noise floor 1; among five effects; the rest as in DiagnosisOptions.
constexpr Threshold kThreshold{1, 0.05, 0.6, 0.3, 5};

BootstrapResult Gain(double mean, double p = 0.0005, double error = 0.01) {
  BootstrapResult gain;
  gain.mean = mean;
  gain.error = error;
  gain.p = p;
  return gain;
}

TEST(NothingIsLeft, WithinATwentiethOfTheNoiseOrTwiceItOnceAnEffectWasFound) {
  EXPECT_TRUE(NothingIsLeft(0, 1.04, 1));
  EXPECT_FALSE(NothingIsLeft(0, 1.06, 1));
  EXPECT_TRUE(NothingIsLeft(1, 1.9, 1));
  EXPECT_FALSE(NothingIsLeft(1, 2.1, 1));
}

TEST(IsFreeForm, OfMoreThanTwentyParameters) {
  EXPECT_FALSE(IsFreeForm(20));
  EXPECT_TRUE(IsFreeForm(21));
}

TEST(IsFreeForm, AFreeTimeCourseAlone) {
  for (const Effect* effect : AllEffects()) {
    EXPECT_EQ(IsFreeForm(effect->value_count()), effect->name() == "uniform_force")
        << effect->name();
  }
}

TEST(CanBeJudged, AFreeFormNotByFramesBetweenThoseThatAreFitted) {
  EXPECT_FALSE(CanBeJudged(37, true));
  EXPECT_TRUE(CanBeJudged(37, false));
  EXPECT_TRUE(CanBeJudged(2, true));
}

TEST(IsSurelyBetter, ByMoreThanAStandardError) {
  EXPECT_TRUE(IsSurelyBetter(Gain(0.02)));
  EXPECT_FALSE(IsSurelyBetter(Gain(0.01)));
  EXPECT_FALSE(IsSurelyBetter(Gain(0, 1, 0)));  // the same fit
}

TEST(IsAlike, WithinAStandardError) {
  EXPECT_TRUE(IsAlike(Gain(0.01)));
  EXPECT_FALSE(IsAlike(Gain(0.02)));
  EXPECT_TRUE(IsAlike(Gain(0, 1, 0)));
}

TEST(IsStrongLaw, LeavesLessThanSevenTenths) {
  EXPECT_TRUE(IsStrongLaw(0.69, 1));
  EXPECT_FALSE(IsStrongLaw(0.71, 1));
}

TEST(IsHopeless, AboveFourTimesTheLeast) {
  EXPECT_FALSE(IsHopeless(3.9, 1));
  EXPECT_TRUE(IsHopeless(4.1, 1));
}

TEST(IsWorthRefit, AboveATwentiethOfTheBest) {
  EXPECT_TRUE(IsWorthRefit(0.06, 1));
  EXPECT_FALSE(IsWorthRefit(0.04, 1));
  EXPECT_FALSE(IsWorthRefit(0, 0));
}

TEST(IsNear, WithinAQuarterOfTheError) {
  EXPECT_TRUE(IsNear(1.2, 1));
  EXPECT_FALSE(IsNear(1.3, 1));
}

// sqrt(25 - 0.6 (25 - 1)) = 3.26
TEST(IsWorthIt, ExplainsThreeFifthsOfTheSquaredErrorAboveTheNoise) {
  EXPECT_TRUE(IsWorthIt(Gain(1.76), 5, kThreshold));
  EXPECT_FALSE(IsWorthIt(Gain(1.72), 5, kThreshold));
}

// 1.1^2 - 1.01^2 = 0.436^2, 1.04^2 - 1 = 0.286^2
TEST(IsWorthIt, ExplainsAsMuchAsThreeTenthsOfTheNoiseWouldAdd) {
  EXPECT_TRUE(IsWorthIt(Gain(0.09), 1.1, kThreshold));
  EXPECT_FALSE(IsWorthIt(Gain(0.04), 1.04, kThreshold));
  EXPECT_FALSE(IsWorthIt(Gain(0.04), 0.9, kThreshold));  // no error above the noise
}

TEST(IsWorthIt, BeatsChanceAmongAllThatWereTried) {
  EXPECT_TRUE(IsWorthIt(Gain(4, 0.009), 5, kThreshold));
  EXPECT_FALSE(IsWorthIt(Gain(4, 0.011), 5, kThreshold));
  Threshold one = kThreshold;
  one.tried = 1;
  EXPECT_TRUE(IsWorthIt(Gain(4, 0.011), 5, one));
}

TEST(WhyNotWorthIt, NamesTheConditionThatFailsWithItsNumbers) {
  EXPECT_EQ(WhyNotWorthIt(Gain(1.8), 5, kThreshold), "");
  EXPECT_EQ(WhyNotWorthIt(Gain(1.2), 5, kThreshold),
            "it takes 44 % of the squared error above the noise, more than 60 % are asked");
  EXPECT_EQ(WhyNotWorthIt(Gain(4, 0.03), 5, kThreshold),
            "its gain may be chance: p is 0.03, below 0.01 is asked");
  EXPECT_EQ(WhyNotWorthIt(Gain(0.04), 1.04, kThreshold),
            "it takes 286 mm off the error, in squares, more than 300 mm, a part of the noise, are "
            "asked");
}

// A fit whose held-out errors are `mean` in the mean, each up to 1 off.
Scored MakeFit(Eigen::Index parameters, double mean, std::uint64_t seed) {
  Random random(seed);
  Scored fit{parameters, mean, {}};
  for (int i = 0; i < 100; ++i) fit.held.push_back(random(-1, 1));
  const double drawn = std::accumulate(fit.held.begin(), fit.held.end(), 0.0) / 100;
  for (double& error : fit.held) error += mean - drawn;
  return fit;
}

TEST(ChooseSimplest, TakesFewerParametersWhereErrorsAreAlike) {
  // better by 0.02; the means of 100 errors differ by 0.08 by chance
  EXPECT_EQ(ChooseSimplest({MakeFit(37, 2, 1), MakeFit(2, 2.02, 2)}, 1, 5, 0), 1U);
}

TEST(ChooseSimplest, TakesTheBestWhereErrorsDiffer) {
  EXPECT_EQ(ChooseSimplest({MakeFit(2, 4, 1), MakeFit(37, 2, 2)}, 1, 5, 0), 1U);
  EXPECT_EQ(ChooseSimplest({MakeFit(37, 2, 2), MakeFit(2, 4, 1)}, 1, 5, 0), 0U);
}

TEST(ChooseSimplest, TakesFewerParametersWhereThatLeavesNoMoreThanNoise) {
  EXPECT_EQ(ChooseSimplest({MakeFit(37, 2, 1), MakeFit(2, 4, 2)}, 3.9, 5, 0), 1U);
}

// Surely better, but by less than fits can tell.
TEST(ChooseSimplest, TakesFewerParametersWhereErrorsHardlyDiffer) {
  const auto steady = [](int parameters, double error) {
    return Scored{parameters, error, std::vector<double>(100, error)};
  };
  EXPECT_EQ(ChooseSimplest({steady(4, 2), steady(2, 2.04)}, 1, 5, 0), 1U);
  EXPECT_EQ(ChooseSimplest({steady(4, 2), steady(2, 2.06)}, 1, 5, 0), 0U);
}

TEST(ChooseSimplest, TakesTheOnlyOne) {
  EXPECT_EQ(ChooseSimplest({MakeFit(3, 1, 1)}, 1, 5, 0), 0U);
}

}  // namespace
}  // namespace physpring
