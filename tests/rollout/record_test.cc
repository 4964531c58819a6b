// SPDX-License-Identifier: Apache-2.0
#include "rollout/record.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/rollout/record_scene.h"

namespace physpring {
namespace {

std::string Bytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

double HiddenFraction(const Points& points) {
  return static_cast<double>(points.row(0).array().isNaN().count()) /
         static_cast<double>(points.cols());
}

TEST_F(RecordSceneTest, SheetIsAllPointsButForHeldVertices) {
  const Recording recording = RecordScene(SheetScene(), {});
  EXPECT_EQ(recording.point_count(), 18);
  EXPECT_EQ(recording.interior_count(), 0);
  EXPECT_EQ(recording.controller_count(), 2);
}

TEST_F(RecordSceneTest, SolidHasAnInterior) {
  const std::string solid = R"(
    <flexcomp name="solid" type="grid" dim="3" count="4 5 4" spacing="0.02 0.02 0.02" pos="0 0 0.5"
              mass="0.05" radius="0.002">
      <elasticity young="1e4" poisson="0.2" damping="0.01"/>
      <contact selfcollide="none"/>
    </flexcomp>)";
  const Recording recording = RecordScene(
      WriteScene(Scene(solid, "<connect body1='solid_0' body2='hand' anchor='0 0 0'/>", kLift)),
      {.duration = 0.1});
  EXPECT_EQ(recording.interior_count(), 2 * 3 * 2);
  EXPECT_EQ(recording.controller_count(), 1);
  EXPECT_EQ(recording.point_count(), 4 * 5 * 4 - 12 - 1);
  // the interior is the vertices off the faces
  EXPECT_NEAR(recording.interior.row(1).minCoeff(), -0.02, 1e-12);
  EXPECT_NEAR(recording.interior.row(1).maxCoeff(), 0.02, 1e-12);
}

TEST_F(RecordSceneTest, FramesEndAtTheLastKeyframe) {
  const Recording recording = RecordScene(SheetScene(), {.fps = 50});
  EXPECT_EQ(recording.frame_count(), 26);
  EXPECT_EQ(recording.fps, 50);
  EXPECT_EQ(recording.train_frames, 18);
}

TEST_F(RecordSceneTest, DeclaresMassGravityAndGround) {
  const Recording recording = RecordScene(SheetScene(), {.duration = 0.1});
  EXPECT_NEAR(recording.mass, 0.05, 1e-12);  // of the flex, not of the hand
  EXPECT_EQ(recording.gravity, Eigen::Vector3d(0, 0, -9.81));
  ASSERT_TRUE(recording.ground.has_value());
  EXPECT_TRUE(recording.ground->isApprox(Eigen::Vector4d(0, 0, 1, -0.5)));
  EXPECT_TRUE(recording.warnings.empty());
}

TEST_F(RecordSceneTest, TiedVerticesFollowTheHand) {
  const Recording recording = RecordScene(SheetScene(), {});
  const Points way = recording.controllers.back() - recording.controllers.front();
  // equality constraints are soft: 1 mm
  for (Eigen::Index c = 0; c < way.cols(); ++c) {
    EXPECT_LT((way.col(c) - Eigen::Vector3d(0.1, 0, 0.2)).norm(), 1e-3);
  }
}

TEST_F(RecordSceneTest, VertexOnMocapBodyIsAController) {
  const Recording recording = RecordScene(TwoLinesScene(), {});
  ASSERT_EQ(recording.controller_count(), 1);
  EXPECT_EQ(recording.point_count(), 3);
  EXPECT_LT((recording.controllers.front().col(0) - Eigen::Vector3d(-0.04, -0.03, 0.5)).norm(),
            1e-12);
  // key 1 is at 0.3 s, frame 9
  EXPECT_LT((recording.controllers[9].col(0) - Eigen::Vector3d(0.06, -0.03, 0.7)).norm(), 1e-12);
}

TEST_F(RecordSceneTest, UnheldPartFallsFreely) {
  const Recording recording = RecordScene(TwoLinesScene(), {.fps = 20});
  const double h = 0.002;  // 25 steps a frame
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    // semi-implicit Euler falls g t (t + h) / 2
    const double t = frame / 20.0;
    EXPECT_NEAR(recording.points[static_cast<std::size_t>(frame)](2, 1), 3 - 9.81 * t * (t + h) / 2,
                1e-9);
  }
}

TEST_F(RecordSceneTest, StartsStressFreeAndAtRest) {
  const Recording recording = RecordScene(SheetScene(), {.duration = 0.1});
  EXPECT_FALSE(recording.rest_given);
  EXPECT_EQ(recording.rest, recording.start);
  EXPECT_EQ(recording.velocity, Points::Zero(3, 18));
}

// The hand holds still from -0.2 s on.
constexpr char kHold[] = R"(
  <key time="-0.2" mpos="-0.04 -0.03 0.5"/>
  <key time="0.2" mpos="-0.04 -0.03 0.5"/>)";

TEST_F(RecordSceneTest, SettledObjectHasItsRestShape) {
  const Recording settled = RecordScene(WriteScene(Scene(kSheet, kTwoTies, kHold)), {});
  const Recording fresh = RecordScene(SheetScene(), {.duration = 0.1});
  EXPECT_TRUE(settled.rest_given);
  EXPECT_EQ(settled.rest, fresh.start);
  EXPECT_LT(settled.start.row(2).minCoeff(), 0.49);  // it has sagged
}

TEST_F(RecordSceneTest, VelocityIsThatOfFrameZero) {
  const Recording sagging =
      RecordScene(WriteScene(Scene(kSheet, kTwoTies, kHold)), {.duration = 0.01, .fps = 500});
  const Points velocity = (sagging.points[1] - sagging.points[0]) * sagging.fps;
  EXPECT_GT(velocity.norm(), 1);
  // one step of 2 ms later, at accelerations of about g
  EXPECT_LT((velocity - sagging.velocity).cwiseAbs().maxCoeff(), 3 * 9.81 * 0.002);
}

TEST_F(RecordSceneTest, SameSeedGivesSameBytes) {
  const RecordOptions options{.noise = 1e-3, .occlusion = 0.2, .vary = 0.01, .seed = 5};
  const std::string scene = SheetScene();
  WriteRecording(RecordScene(scene, options), folder_.File("a.npz"));
  WriteRecording(RecordScene(scene, options), folder_.File("b.npz"));
  EXPECT_EQ(Bytes(folder_.File("a.npz")), Bytes(folder_.File("b.npz")));
}

TEST_F(RecordSceneTest, NoiseHasTheGivenDeviationAndSparesFrameZero) {
  const Recording exact = RecordScene(SheetScene(), {.fps = 200});
  const Recording noisy = RecordScene(SheetScene(), {.noise = 1e-3, .fps = 200});
  EXPECT_EQ(noisy.points[0], exact.points[0]);
  double squares = 0;
  for (std::size_t frame = 1; frame < exact.points.size(); ++frame) {
    squares += (noisy.points[frame] - exact.points[frame]).squaredNorm();
    EXPECT_EQ(noisy.controllers[frame], exact.controllers[frame]);
  }
  const double count = 3 * 18 * 100;  // coordinates: a deviation known to 1 / sqrt(2 * 5400) = 1 %
  EXPECT_NEAR(std::sqrt(squares / count), 1e-3, 0.05e-3);
}

TEST_F(RecordSceneTest, OtherSeedGivesOtherNoise) {
  const Recording a = RecordScene(SheetScene(), {.noise = 1e-3, .seed = 1, .duration = 0.1});
  const Recording b = RecordScene(SheetScene(), {.noise = 1e-3, .seed = 2, .duration = 0.1});
  EXPECT_NE(a.points[1], b.points[1]);
}

TEST_F(RecordSceneTest, OcclusionHidesItsFractionAndSparesFrameZero) {
  const Recording recording = RecordScene(SheetScene(), {.occlusion = 0.25});
  EXPECT_EQ(HiddenFraction(recording.points[0]), 0);
  bool wanders = false;
  for (std::size_t frame = 1; frame < recording.points.size(); ++frame) {
    EXPECT_NEAR(HiddenFraction(recording.points[frame]), 0.25, 0.51 / 18);
    wanders |=
        (recording.points[frame].array().isNaN() != recording.points[1].array().isNaN()).any();
  }
  EXPECT_TRUE(wanders);
}

TEST_F(RecordSceneTest, VariationMovesLaterKeyframesOnly) {
  const Recording plain = RecordScene(SheetScene(), {});
  const Recording varied = RecordScene(SheetScene(), {.vary = 0.03, .seed = 1});
  const Recording other = RecordScene(SheetScene(), {.vary = 0.03, .seed = 2});
  EXPECT_EQ(varied.start, plain.start);
  const double shift = (varied.controllers.back() - plain.controllers.back()).cwiseAbs().maxCoeff();
  EXPECT_GT(shift, 1e-3);
  EXPECT_LT(shift, 0.03 + 1e-3);  // 1 mm: soft constraints
  EXPECT_GT((varied.controllers.back() - other.controllers.back()).norm(), 1e-3);
}

TEST_F(RecordSceneTest, WarnsOfGeomsThatARecordingDoesNotHold) {
  const std::string box = "<geom type='box' size='0.1 0.1 0.1' pos='0.5 0 0'/>";
  const Recording recording =
      RecordScene(WriteScene(Scene(kSheet + box, kTwoTies, kLift)), {.duration = 0.1});
  ASSERT_EQ(recording.warnings.size(), 1u);
  EXPECT_NE(recording.warnings[0].find("1 geom"), std::string::npos) << recording.warnings[0];
}

// The scenes that the demo uses: points, interior, controllers; whether it hangs in the air, at
// rest.
struct Demo {
  const char* name;
  int points, interior, controllers;
  bool hangs;
};

class DemoScene : public testing::TestWithParam<Demo> {};

TEST_P(DemoScene, IsRecorded) {
  const Demo& demo = GetParam();
  const Recording recording =
      RecordScene(fmt::format("{}/demo/{}.xml", PHYSPRING_MODELS, demo.name), {.duration = 0.2});
  EXPECT_EQ(recording.point_count(), demo.points);
  EXPECT_EQ(recording.interior_count(), demo.interior);
  EXPECT_EQ(recording.controller_count(), demo.controllers);
  EXPECT_EQ(recording.ground.has_value(), !demo.hangs);
  EXPECT_EQ(recording.rest_given, demo.hangs);
  EXPECT_TRUE(recording.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(All, DemoScene,
                         testing::Values(Demo{"rope", 76, 0, 4, false},
                                         Demo{"cloth", 219, 0, 6, false},
                                         Demo{"block", 164, 72, 4, false},
                                         Demo{"cord", 20, 0, 1, true}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace physpring
