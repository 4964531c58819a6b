// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/level_network.h"

#include <gtest/gtest.h>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/small_twin.h"
#include "trainer/motion/lifted_loss.h"

namespace physpring {
namespace {

constexpr int kLatent = 6, kFrames = 5;

TEST(LevelNetwork, ChangesNothingAtFirst) {
  const Twin twin = SmallTwin(3);
  const GraphNetwork network(kLatent, 1);
  const SpringMassSystem& base = twin.levels[2].system;
  const LevelNetwork level(network, twin, base, network.first_weights());
  EXPECT_EQ(level.corrected().stiffness, base.stiffness);
  EXPECT_EQ(level.corrected().dashpot, base.dashpot);
  EXPECT_EQ(level.corrected().drag, base.drag);
  EXPECT_NEAR(level.corrected().contact.surface.friction, base.contact.surface.friction, 1e-15);
}

// Weights -> features of levels 0 to 2 -> corrections -> rollout of level 2 -> lift -> loss.
TEST(LevelNetwork, GradientOfTheWholePipelineIsTheDerivative) {
  const Twin twin = SmallTwin(3);
  const Recording recording = RecordingOfMotion(twin, kFrames);
  const LiftedMotion::Options options{.rollout = {.substeps = 40}};
  const LiftedMotion motion(twin, 2, {{&recording, kFrames}}, options);
  const GraphNetwork network(kLatent, 1);
  Random random(2);
  Eigen::VectorXd weights = network.first_weights();
  for (double& weight : weights) weight += random(-0.1, 0.1);

  const SpringMassSystem& base = twin.levels[2].system;
  const LevelNetwork level(network, twin, base, weights);
  const auto loss = ComputeLiftedLoss(motion, level.corrected());
  ASSERT_TRUE(loss);
  const Eigen::VectorXd weights_bar = level.Adjoint(loss->gradient);
  ASSERT_GT(weights_bar.norm(), 0);
  // every seventh weight, so that all layers have their turn
  std::vector<CheckedVariable> variables;
  for (int k = 0; k < weights.size(); k += 7) {
    variables.push_back({std::to_string(k), &weights[k], 1e-3, weights_bar[k]});
  }
  const auto value = [&] {
    const LevelNetwork moved(network, twin, base, weights);
    return static_cast<long double>(ComputeLiftedLoss(motion, moved.corrected())->loss);
  };
  // the loss is summed in double
  const GradientReport report = CheckGradient(value, variables, 1e-5);
  EXPECT_TRUE(report.passed) << report.log;
}

}  // namespace
}  // namespace physpring
