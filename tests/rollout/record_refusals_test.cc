// SPDX-License-Identifier: Apache-2.0
// Scenes and options that cannot be recorded: one line says why.
#include "tests/rollout/record_scene.h"

namespace physpring {
namespace {

TEST_F(RecordSceneTest, RefusesMissingFile) { ErrorOf(folder_.File("missing.xml")); }

TEST_F(RecordSceneTest, RefusesWhatIsNotXml) { ExpectRefused("PK\x03\x04 no scene", "XML"); }

TEST_F(RecordSceneTest, RefusesSceneThatDoesNotCompile) {
  ExpectRefused(Scene(kSheet, "<connect body1='nobody' body2='hand' anchor='0 0 0'/>", kLift),
                "nobody");
}

TEST_F(RecordSceneTest, RefusesSceneWithoutFlex) {
  ExpectRefused(Scene("", "", kLift), "has 0 flexes");
}

TEST_F(RecordSceneTest, RefusesTwoFlexes) {
  std::string second = kSheet;
  second.replace(second.find("sheet"), 5, "other");
  ExpectRefused(Scene(kSheet + second, kTwoTies, kLift), "has 2 flexes");
}

TEST_F(RecordSceneTest, RefusesSceneWithoutMocapBody) {
  std::string scene = Scene(kSheet, "", "<key time='1'/>");
  scene.replace(scene.find("mocap=\"true\""), 12, "");
  ExpectRefused(scene, "no mocap body");
}

TEST_F(RecordSceneTest, RefusesFlexThatNobodyHolds) {
  ExpectRefused(Scene(kSheet, "", kLift), "no mocap body holds the flex");
}

TEST_F(RecordSceneTest, IgnoresInactiveTies) {
  ExpectRefused(
      Scene(kSheet, "<connect body1='sheet_0' body2='hand' anchor='0 0 0' active='false'/>", kLift),
      "no mocap body holds the flex");
}

TEST_F(RecordSceneTest, RefusesSceneWithoutKeyframes) {
  ExpectRefused(Scene(kSheet, kTwoTies, ""), "no keyframes");
}

TEST_F(RecordSceneTest, RefusesKeyframesOutOfOrder) {
  ExpectRefused(Scene(kSheet, kTwoTies, "<key time='1'/><key time='0.5'/>"), "times must increase");
}

TEST_F(RecordSceneTest, RefusesMotionWithoutDuration) {
  ExpectRefused(Scene(kSheet, kTwoTies, "<key time='0'/>"), "last keyframe");
}

TEST_F(RecordSceneTest, RefusesInterpolatedFlex) {
  ExpectRefused(Scene(R"(<flexcomp name="sheet" type="grid" dim="3" count="3 3 3" dof="trilinear"
                         spacing="0.1 0.1 0.1" radius="0.01"><elasticity young="1e4"/>
                         </flexcomp>)",
                      "", kLift),
                "interpolated");
}

TEST_F(RecordSceneTest, RefusesFlexInsideMocapBody) {
  const std::string carried = R"(
    <body name="carrier" mocap="true"><flexcomp name="rope" type="grid" dim="1" count="5 1 1"
      spacing="0.1 0.1 0.1" mass="0.1" radius="0.005"><edge equality="true"/><pin id="0"/>
    </flexcomp></body>)";
  ExpectRefused(Scene(carried, "", kLift), "carry it along");
}

TEST_F(RecordSceneTest, RefusesTwoGrounds) {
  const std::string wall = "<geom type='plane' size='1 1 0.1' pos='3 0 0' zaxis='-1 0 0'/>";
  ExpectRefused(Scene(kSheet + wall, kTwoTies, kLift), "two ground planes");
}

TEST_F(RecordSceneTest, RefusesUnstableSimulation) {
  std::string scene = Scene(kSheet, kTwoTies, kLift);
  scene.replace(scene.find("discrete"), 8, "Euler");
  scene.replace(scene.find("1e4"), 3, "1e9");
  ExpectRefused(scene, "unstable");
}

TEST_F(RecordSceneTest, RefusesOptionsOutOfRange) {
  const std::string scene = SheetScene();
  EXPECT_NE(ErrorOf(scene, {.noise = -1}).find("noise is -1"), std::string::npos);
  EXPECT_NE(ErrorOf(scene, {.occlusion = 1}).find("occlusion is 1"), std::string::npos);
  EXPECT_NE(ErrorOf(scene, {.vary = std::nan("")}).find("vary is nan"), std::string::npos);
  EXPECT_NE(ErrorOf(scene, {.duration = -2}).find("duration is -2"), std::string::npos);
  EXPECT_NE(ErrorOf(scene, {.duration = 0.01}).find("1 frames"), std::string::npos);
  EXPECT_NE(ErrorOf(scene, {.fps = 0}).find("fps is 0"), std::string::npos);
}

}  // namespace
}  // namespace physpring
