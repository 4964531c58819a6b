// SPDX-License-Identifier: Apache-2.0
// Undeclared effects that only tendons have, that flexes have in their way, or that are refused.
#include "rollout/undeclared_effects.h"
#include "tests/rollout/undeclared_scene.h"

namespace physpring {
namespace {

class TendonScene : public UndeclaredScene {};

TEST_F(TendonScene, RatioAndSlipStrainAreOfTheSpring) {
  // k r / L^2 = 900, k L s = 0.3
  const Recording ratio = Record({}, {{"stiffening.cubic_stiffness_ratio", 0.9}});
  const Recording cubic = Record({}, {{"stiffening.cubic_n_per_m3", 900}});
  const Recording slip = Record({}, {{"dry_friction.slip_strain", 0.3}});
  const Recording force = Record({}, {{"dry_friction.force_n", 0.3}});
  EXPECT_LT((ratio.points.back() - cubic.points.back()).norm(), 1e-9);
  EXPECT_LT((slip.points.back() - force.points.back()).norm(), 1e-9);
}

TEST_F(TendonScene, SlackSpringDoesNotPush) {
  // 0.2 m above where the spring begins to pull, on the other side of the hand: nothing holds it
  const Recording recording = Record({.below = -0.09}, {{"tension_only.slack_share", 1}});
  const auto fall = Integrate([](double, double, double) { return -kGravity; });
  for (std::size_t frame = 0; frame < 8; ++frame) {  // 0.13 m
    EXPECT_NEAR(recording.points[frame](2, kHanging) - 0.59, fall[frame], kSame);
  }
  const Recording pushed = Record({.below = -0.09}, {});
  EXPECT_GT(std::abs(pushed.points[7](2, kHanging) - 0.59 - fall[7]), 1e-3);
}

TEST_F(TendonScene, SlackSpringHasItsOwnRestLength) {
  const Recording recording = Record({}, {{"tension_only.slack_share", 1},
                                          {"rest_length.strain_low_end", 0.2},
                                          {"rest_length.strain_high_end", 0.2}});
  ExpectWay(recording, kHanging, 2, Integrate([](double, double z, double) {
              return kSpring * std::max(0.0, 0.1 - z - 0.12) / kMass - kGravity;
            }),
            kSame);
}

TEST_F(TendonScene, YieldedSpringPullsWithItsLimit) {
  // at the strain 0.5: k 0.05 m = 0.5 N, then constant
  const Recording recording = Record({}, {{"yield.yield_strain", 0.5}});
  double plastic = 0;
  ExpectWay(recording, kHanging, 2, Integrate([&](double, double z, double) {
              plastic = std::clamp(plastic, -z - 0.05, -z + 0.05);
              return -kSpring * (z + plastic) / kMass - kGravity;
            }),
            1e-4);  // MuJoCo updates the rest length at another moment of the step
}

TEST_F(TendonScene, FrictionWithTheGroundChanges) {
  SceneOptions scene{.gravity = "5 0 -9.81", .free_place = "0.3 0 0.02"};
  scene.ground = "<geom type='plane' size='1 1 1' friction='0.3'/>";
  scene.geom = "condim='3'";
  const Recording recording = Record(scene, {{"ground_contact.friction_change", -0.2}});
  const double t = kDuration;  // slides with g_x - mu g_z; soft contacts: 2 %
  const double way = (5 - (0.3 - 0.2) * kGravity) * t * t / 2;
  EXPECT_NEAR(recording.points.back()(0, kFree) - 0.3, way, 0.02 * way);
}

TEST_F(TendonScene, RecordsSitesOfTendons) {
  const Recording recording = Record({}, {});
  EXPECT_EQ(recording.point_count(), 3);
  EXPECT_EQ(recording.controller_count(), 1);
  EXPECT_NEAR(recording.mass, 3 * kMass, 1e-12);
}

constexpr char kSheet[] = R"(
  <mujoco><option timestep="0.001" gravity="0 0 {}" integrator="discrete" solver="CG"
    iterations="500"/><worldbody><body name="hand" mocap="true" pos="0 0 0.5"/>
    <flexcomp name="sheet" type="grid" dim="2" count="5 5 1" spacing="0.02 0.02 0.02" mass="0.05"
      pos="0 0 0.5" radius="0.002"><elasticity young="3e4" poisson="0.2" thickness="0.002"
      damping="0.1" elastic2d="both"/><contact selfcollide="none"/></flexcomp></worldbody>
    <equality><connect body1="sheet_12" body2="hand" anchor="0 0 0"/></equality>
    <keyframe><key time="0" mpos="0 0 0.5"/><key time="2" mpos="0 0 0.5"/></keyframe></mujoco>)";

// Finite elements of other rest lengths are larger by as much.
TEST_F(TendonScene, SheetGrowsToItsRestLength) {
  RecordOptions options;
  options.effects = {{"rest_length.strain_low_end", 0.1}, {"rest_length.strain_high_end", 0.1}};
  const Recording recording = RecordScene(WriteScene(fmt::format(kSheet, 0)), options);
  const Points& last = recording.points.back();
  const double before = (recording.points[0].col(0) - recording.points[0].col(23)).norm();
  EXPECT_NEAR((last.col(0) - last.col(23)).norm() / before, 1.1, 0.005);  // still swings a little
}

TEST_F(TendonScene, SheetThatYieldsSagsMore) {
  RecordOptions options;
  const std::string scene = WriteScene(fmt::format(kSheet, -9.81));
  const Recording elastic = RecordScene(scene, options);
  options.effects = {{"yield.yield_strain", 0.002}};
  const Recording yielding = RecordScene(scene, options);
  EXPECT_LT(yielding.points.back().row(2).minCoeff(),
            elastic.points.back().row(2).minCoeff() - 1e-3);
}

TEST_F(TendonScene, RefusesWhatTheSceneCannotHave) {
  const SceneOptions flex{.springs = Springs::kEdges};
  for (const char* name : {"tension_only.slack_share", "yield.yield_strain",
                           "dry_friction.slip_strain", "ground_contact.friction_change"}) {
    const std::string message = ErrorOf(flex, {{name, 1}});
    EXPECT_NE(message.find(fmt::format("scene.xml: cannot have the effect {}: ", name)),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("it can have air_drag.drag_kg_per_m, "), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_NE(ErrorOf({}, {{"tension_only.slack_share", 0.5}}).find("wholly"), std::string::npos);
}

TEST_F(TendonScene, RefusesAnEffectWithoutAmount) {
  EXPECT_NE(ErrorOf({}, {{"air_drag.wind_x_m_per_s", 1}})
                .find("air_drag.wind_x_m_per_s needs air_drag.drag_kg_per_m, too"),
            std::string::npos);
}

}  // namespace
}  // namespace physpring
