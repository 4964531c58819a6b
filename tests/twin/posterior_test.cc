// SPDX-License-Identifier: Apache-2.0
#include "twin/posterior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/same_twin.h"
#include "tests/support/small_twin.h"
#include "twin/error.h"
#include "twin/stability.h"
#include "twin/twin.h"

namespace physpring {
namespace {

// A posterior of these many directions that changes nothing.
Posterior Certain(const SpringMassSystem& system, int directions) {
  return {Eigen::MatrixXd::Zero(directions, system.spring_count()),
          Eigen::MatrixXd::Zero(directions, system.spring_count()),
          Eigen::VectorXd::Zero(directions), Eigen::MatrixXd::Zero(directions, kContactCount),
          Eigen::MatrixXd::Zero(directions, EffectValueCount(system.effects))};
}

Twin TwinWithPosterior() {
  Twin twin = SmallTwin(3);
  twin.posterior = Certain(twin.levels[0].system, 2);
  return twin;
}

TEST(Posterior, MovesWhatItSays) {
  SpringMassSystem system = SmallTwin(1).levels[0].system;
  system.effects = {{"air_drag", Eigen::Vector4d(0.02, 3, 0, 0)}};
  Posterior posterior = Certain(system, 2);
  posterior.stiffness(0, 5) = 0.3;
  posterior.stiffness(1, 5) = -0.1;
  posterior.loss_time(1, 7) = 0.2;
  posterior.drag[0] = 0.5;
  posterior.contact(0, 1) = 0.25;
  posterior.effects(1, 1) = -2;
  const SpringMassSystem moved = MovedAlong(posterior, system, Eigen::Vector2d(2, 3));
  EXPECT_DOUBLE_EQ(moved.stiffness[5], system.stiffness[5] * std::exp(0.6 - 0.3));
  EXPECT_DOUBLE_EQ(moved.dashpot[5], system.dashpot[5] * std::exp(0.6 - 0.3))
      << "the loss time stays";
  EXPECT_EQ(moved.stiffness[7], system.stiffness[7]);
  EXPECT_DOUBLE_EQ(moved.dashpot[7], system.dashpot[7] * std::exp(0.6));
  EXPECT_DOUBLE_EQ(moved.drag, system.drag * std::exp(1.0));
  EXPECT_DOUBLE_EQ(moved.contact.surface.friction, system.contact.surface.friction * std::exp(0.5));
  EXPECT_EQ(moved.contact.surface.restitution, system.contact.surface.restitution);
  EXPECT_DOUBLE_EQ(moved.effects[0].values[1], 3 - 6);
  EXPECT_EQ(moved.rest_length, system.rest_length);
  EXPECT_EQ(moved.mass, system.mass);
}

TEST(Posterior, KeepsValuesWithinBounds) {
  SpringMassSystem system = SmallTwin(1).levels[0].system;
  system.effects = {{"air_drag", Eigen::Vector4d(0.02, 3, 0, 0)}};
  Posterior posterior = Certain(system, 1);
  posterior.contact.setConstant(10);
  posterior.effects.setConstant(-1e9);
  const SpringMassSystem moved = MovedAlong(posterior, system, Eigen::VectorXd::Ones(1));
  EXPECT_EQ(moved.contact.surface.restitution, 1);
  EXPECT_EQ(moved.contact.surface.friction, 2);
  EXPECT_NO_THROW(moved.Validate("moved"));
}

TEST(SampleOf, IsTheSameForTheSameSeedAndNumber) {
  Twin twin = TwinWithPosterior();
  twin.posterior.stiffness.row(0).setConstant(0.2);
  twin.posterior.drag[1] = 0.3;
  ExpectSameTwin(SampleOf(twin, 7, 3), SampleOf(twin, 7, 3));
  const auto stiffness = [&](std::uint64_t seed, int index) {
    return SampleOf(twin, seed, index).levels[0].system.stiffness[0];
  };
  EXPECT_NE(stiffness(7, 3), stiffness(7, 4));
  EXPECT_NE(stiffness(7, 3), stiffness(8, 3));
}

// Logarithms have the deviations and the correlation that the directions say.
TEST(SampleOf, IsDrawnFromTheDistribution) {
  Twin twin = TwinWithPosterior();
  twin.levels.resize(1);
  twin.posterior.stiffness(0, 0) = 0.2;
  twin.posterior.stiffness(0, 1) = 0.1;
  twin.posterior.stiffness(1, 1) = 0.1;
  constexpr int kDraws = 3000;
  Eigen::MatrixXd drawn(kDraws, 2);
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd stiffness = SampleOf(twin, 1, i).levels[0].system.stiffness;
    for (int e : {0, 1}) drawn(i, e) = std::log(stiffness[e] / twin.levels[0].system.stiffness[e]);
  }
  const Eigen::RowVector2d mean = drawn.colwise().mean();
  const Eigen::Matrix2d covariance =
      (drawn.rowwise() - mean).transpose() * (drawn.rowwise() - mean) / kDraws;
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.015);
  EXPECT_NEAR(covariance(0, 0), 0.04, 0.004);
  EXPECT_NEAR(covariance(1, 1), 0.02, 0.002);
  EXPECT_NEAR(covariance(0, 1), 0.02, 0.002);
}

TEST(SampleOf, ChangesCoarseLevelsAlike) {
  Twin twin = TwinWithPosterior();
  twin.posterior.stiffness.row(0).setConstant(0.3);
  twin.posterior.loss_time.row(1).setConstant(0.2);
  twin.posterior.drag[0] = 0.1;
  const Twin sample = SampleOf(twin, 1, 0);
  const double factor = sample.levels[0].system.stiffness[0] / twin.levels[0].system.stiffness[0];
  const double lossier = sample.levels[0].system.dashpot[0] / twin.levels[0].system.dashpot[0];
  EXPECT_NE(factor, 1);
  EXPECT_NE(lossier, factor);
  for (int level : {1, 2}) {
    const SpringMassSystem& before = twin.levels[level].system;
    const SpringMassSystem& after = sample.levels[level].system;
    EXPECT_LT((after.stiffness - factor * before.stiffness).norm(),
              1e-12 * before.stiffness.norm());
    EXPECT_LT((after.dashpot - lossier * before.dashpot).norm(), 1e-12 * before.dashpot.norm());
    EXPECT_DOUBLE_EQ(after.drag / before.drag,
                     sample.levels[0].system.drag / twin.levels[0].system.drag);
  }
}

// The springs that join the members of two nodes decide on the spring of these nodes.
TEST(SampleOf, GivesACoarseSpringTheMeanOfWhatItStandsFor) {
  Twin twin = TwinWithPosterior();
  const SpringMassSystem& dense = twin.levels[0].system;
  const std::vector<int>& node = twin.levels[1].assignment;
  const auto [a, b] = twin.levels[1].system.springs[0];
  double weighted = 0, weight = 0;
  for (int e = 0; e < dense.spring_count(); ++e) {
    const auto [i, j] = dense.springs[e];
    if (dense.IsControllerSpring(e)) continue;
    if (std::minmax(node[i], node[j]) != std::minmax(a, b)) continue;
    twin.posterior.stiffness(0, e) = 0.1 * (1 + e % 3);
    weighted += dense.stiffness[e] * twin.posterior.stiffness(0, e);
    weight += dense.stiffness[e];
  }
  ASSERT_GT(weight, 0);
  const Twin sample = SampleOf(twin, 1, 0);
  double drawn = 0;  // the standard normal number
  for (int e = 0; e < dense.spring_count() && drawn == 0; ++e) {
    if (twin.posterior.stiffness(0, e) == 0) continue;
    drawn = std::log(sample.levels[0].system.stiffness[e] / dense.stiffness[e]) /
            twin.posterior.stiffness(0, e);
  }
  EXPECT_NEAR(sample.levels[1].system.stiffness[0],
              twin.levels[1].system.stiffness[0] * std::exp(drawn * weighted / weight), 1e-9);
}

TEST(SampleOf, GivesStiffLevelsTheSubstepsThatTheyNeed) {
  Twin twin = TwinWithPosterior();
  twin.posterior.stiffness.row(0).setConstant(3);
  bool stiffer = false;
  for (int i = 0; i < 8; ++i) {
    const Twin sample = SampleOf(twin, 1, i);
    for (std::size_t level = 0; level < 3; ++level) {
      const TwinLevel& one = sample.levels[level];
      EXPECT_GE(one.substeps_per_second, twin.levels[level].substeps_per_second);
      EXPECT_LT(1.0 / one.substeps_per_second, ComputeStabilityBound(one.system).timestep);
      stiffer |= one.substeps_per_second > twin.levels[level].substeps_per_second;
    }
  }
  EXPECT_TRUE(stiffer);
}

TEST(SampleOf, RefusesNumbersThatNoTwinHas) {
  Twin twin = TwinWithPosterior();
  twin.posterior.stiffness.setConstant(1e6);  // finite, as a file may have it
  try {
    for (int i = 0; i < 4; ++i) SampleOf(twin, 0, i);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("sample"), std::string::npos) << error.what();
  }
}

TEST(SampleOf, NeedsAPosterior) {
  EXPECT_THROW(SampleOf(SmallTwin(1), 0, 0), Error);
  EXPECT_TRUE(SampleOf(TwinWithPosterior(), 0, 0).posterior.empty());
}

}  // namespace
}  // namespace physpring
