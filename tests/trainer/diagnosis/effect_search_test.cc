// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_search.h"

#include <gtest/gtest.h>

#include "tests/support/random_system.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

// A fit of that many parameters whose held-out errors are `track` in the mean, each up to 1 mm off.
EffectFit MakeFit(int parameters, double track, std::uint64_t seed) {
  Random random(seed);
  EffectFit fit;
  fit.start = {{"an effect", Eigen::VectorXd::Zero(parameters)}};
  for (int i = 0; i < 100; ++i) fit.held.push_back(random(-1e-3, 1e-3));
  const double mean = Mean(fit.held);
  for (double& error : fit.held) error += track - mean;
  fit.track.held = track;
  return fit;
}

TEST(ChooseSimplest, TakesFewerParametersWhereErrorsAreAlike) {
  // better by 0.02 mm; the means of 100 errors differ by 0.08 mm by chance
  EXPECT_EQ(ChooseSimplest({MakeFit(37, 2e-3, 1), MakeFit(2, 2.02e-3, 2)}, 5, 0), 1U);
}

TEST(ChooseSimplest, TakesTheBestWhereErrorsDiffer) {
  EXPECT_EQ(ChooseSimplest({MakeFit(2, 4e-3, 1), MakeFit(37, 2e-3, 2)}, 5, 0), 1U);
  EXPECT_EQ(ChooseSimplest({MakeFit(37, 2e-3, 2), MakeFit(2, 4e-3, 1)}, 5, 0), 0U);
}

TEST(ChooseSimplest, TakesTheOnlyOne) { EXPECT_EQ(ChooseSimplest({MakeFit(3, 1, 1)}, 5, 0), 0U); }

TEST(HasFreeForm, AFreeTimeCourseAlone) {
  for (const Effect* effect : AllEffects()) {
    EXPECT_EQ(HasFreeForm(*effect), effect->name() == "uniform_force") << effect->name();
  }
}

}  // namespace
}  // namespace physpring
