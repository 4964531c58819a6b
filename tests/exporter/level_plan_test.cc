// SPDX-License-Identifier: Apache-2.0
#include "exporter/level_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_twin.h"
#include "twin/error.h"
#include "twin/predict.h"
#include "twin/stability.h"

namespace physpring {
namespace {

std::string MessageOf(const Twin& twin, int level, const ExportOptions& options) {
  try {
    PlanLevel(twin, level, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(LevelPlan, StepsAsTheTrainerDoes) {
  const Twin twin = SmallTwin(2);
  const LevelPlan plan = PlanLevel(twin, 1, {});
  EXPECT_DOUBLE_EQ(plan.substep, 1 / (twin.fps * ChooseSubsteps(twin.levels[1], twin.fps, 0)));
  EXPECT_EQ(plan.timestep, plan.substep);
  EXPECT_EQ(plan.critical_timestep, ComputeStabilityBound(twin.levels[1].system).timestep);
  EXPECT_LT(plan.timestep, plan.critical_timestep);
}

TEST(LevelPlan, ThePluginHasSubstepsOfItsOwn) {
  const Twin twin = SmallTwin(1);
  ExportOptions options;
  options.springs = SpringKind::kPlugin;
  options.timestep = 0.01;
  const LevelPlan plan = PlanLevel(twin, 0, options);
  EXPECT_EQ(plan.timestep, 0.01);
  EXPECT_EQ(plan.substep, PlanLevel(twin, 0, {}).substep);
  options.timestep = 1e-5;
  EXPECT_EQ(PlanLevel(twin, 0, options).substep, 1e-5);
}

TEST(LevelPlan, TakesThePluginWhereTendonsWouldLeaveOutAnEffect) {
  Twin twin = SmallTwin(1);
  std::vector<EffectValues>& effects = twin.levels[0].system.effects;
  effects = {{"stiffening", Eigen::VectorXd::Constant(1, 3)}};
  EXPECT_EQ(PlanLevel(twin, 0, {}).springs, SpringKind::kTendon);
  effects.push_back({"bending", Eigen::VectorXd::Constant(1, 1e-3)});
  const LevelPlan plan = PlanLevel(twin, 0, {});
  EXPECT_EQ(plan.springs, SpringKind::kPlugin);
  EXPECT_TRUE(plan.differences.empty());
  ExportOptions options;
  options.springs = SpringKind::kTendon;
  EXPECT_EQ(PlanLevel(twin, 0, options).differences.size(), 1U);
}

// MuJoCo's tendons know no stages.
TEST(LevelPlan, TendonsOfALevelWithStagesTakeTheSubstepsOfOneStage) {
  Twin twin = SmallTwin(1);
  twin.levels[0].system.dashpot *= 1000;
  const LevelPlan plain = PlanLevel(twin, 0, {});
  ASSERT_EQ(plain.springs, SpringKind::kTendon);
  twin.levels[0].system.dashpot_stages = 8;
  ExportOptions options;
  options.springs = SpringKind::kTendon;
  EXPECT_EQ(PlanLevel(twin, 0, options).substep, plain.substep);
  // so many more that the plugin is better
  const LevelPlan better = PlanLevel(twin, 0, {});
  EXPECT_EQ(better.springs, SpringKind::kPlugin);
  EXPECT_GT(better.substep, 10 * plain.substep);
  twin.levels[0].system.dashpot /= 1000;
  EXPECT_EQ(PlanLevel(twin, 0, {}).springs, SpringKind::kTendon);
}

TEST(LevelPlan, RefusesAnUnstableTimestep) {
  ExportOptions options;
  options.timestep = 0.05;
  EXPECT_THAT(MessageOf(SmallTwin(1), 0, options),
              testing::MatchesRegex("twin 'block' level 0: a time step of 0.05 s is unstable, "
                                    "expected less than 0.00[0-9]+ s"));
}

TEST(LevelPlan, RefusesALevelThatIsNotThere) {
  EXPECT_EQ(MessageOf(SmallTwin(1), 1, {}), "twin block: has no level 1, expected 0 to 0");
}

TEST(LevelPlan, RefusesOddCharactersInAGivenName) {
  ExportOptions options;
  options.name = "my rope";
  EXPECT_EQ(MessageOf(SmallTwin(1), 0, options),
            "name 'my rope': only letters, digits and \"_.-\" may be in a name");
}

TEST(LevelPlan, RefusesNamesThatMujocoGivesItself) {
  for (const char* name : {"world", "main"}) {
    ExportOptions options;
    options.name = name;
    EXPECT_THAT(MessageOf(SmallTwin(1), 0, options), testing::HasSubstr("choose another"));
    Twin twin = SmallTwin(1);
    twin.name = name;
    EXPECT_EQ(PlanLevel(twin, 0, {}).name, "twin");
  }
}

TEST(LevelPlan, SlidingControllersBoundTheTimestep) {
  const Twin twin = SmallTwin(1);
  ExportOptions options;
  options.timestep = 1e-4;
  options.controllers = ControllerKind::kSlide;
  EXPECT_NEAR(PlanLevel(twin, 0, options).largest_timestep, 1.236e-4, 1e-7);
  options.controllers = ControllerKind::kMocap;
  const LevelPlan mocap = PlanLevel(twin, 0, options);
  EXPECT_EQ(mocap.largest_timestep, mocap.critical_timestep);
  options.springs = SpringKind::kPlugin;
  EXPECT_EQ(PlanLevel(twin, 0, options).LargestTimestep(), "any");
}

TEST(LevelPlan, ControllersSlideWhereTheirVelocityCounts) {
  Twin twin = SmallTwin(1);
  ExportOptions options;
  EXPECT_EQ(PlanLevel(twin, 0, options).controllers, ControllerKind::kSlide);
  options.springs = SpringKind::kPlugin;
  EXPECT_EQ(PlanLevel(twin, 0, options).controllers, ControllerKind::kMocap);
  twin.controller_velocity = false;
  options.springs = SpringKind::kFlex;
  EXPECT_EQ(PlanLevel(twin, 0, options).controllers, ControllerKind::kMocap);
}

}  // namespace
}  // namespace physpring
