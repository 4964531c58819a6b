// SPDX-License-Identifier: Apache-2.0
// Scenes that are recorded, or refused: a floor, a hand that lifts, a sheet or lines.
#ifndef PHYSPRING_TESTS_ROLLOUT_RECORD_SCENE_H_
#define PHYSPRING_TESTS_ROLLOUT_RECORD_SCENE_H_

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "rollout/record.h"
#include "tests/support/scene_test.h"
#include "twin/error.h"

namespace physpring {

// A scene around what is between <worldbody> and </keyframe>: a floor, one hand, and keys.
inline std::string Scene(const std::string& bodies, const std::string& equalities,
                         const std::string& keys) {
  return fmt::format(R"(
    <mujoco>
      <option timestep="0.002" integrator="discrete" solver="CG" iterations="500"/>
      <default><equality solref="0.004 1" solimp="0.99 0.999 0.001"/></default>
      <worldbody>
        <geom type="plane" size="1 1 0.1" pos="0 0 -0.5"/>
        <body name="hand" mocap="true" pos="-0.04 -0.03 0.5">
          <geom type="sphere" size="0.01" mass="3" contype="0" conaffinity="0"/>
        </body>
        {}
      </worldbody>
      <equality>{}</equality>
      <keyframe>{}</keyframe>
    </mujoco>)",
                     bodies, equalities, keys);
}

// 5 x 4 vertices, 20 mm apart, the first in the hand
constexpr char kSheet[] = R"(
  <flexcomp name="sheet" type="grid" dim="2" count="5 4 1" spacing="0.02 0.02 0.02" pos="0 0 0.5"
            mass="0.05" radius="0.002">
    <elasticity young="1e4" poisson="0.2" thickness="0.002" damping="0.01" elastic2d="both"/>
    <contact selfcollide="none"/>
  </flexcomp>)";
constexpr char kTwoTies[] = R"(
  <connect body1="sheet_0" body2="hand" anchor="0 0 0"/>
  <connect body1="sheet_1" body2="hand" anchor="0 0 0"/>)";
constexpr char kLift[] = R"(
  <key time="0" mpos="-0.04 -0.03 0.5"/>
  <key time="0.3" mpos="0.06 -0.03 0.7"/>
  <key time="0.5" mpos="0.06 -0.03 0.7"/>)";

// Vertices 0-1 are a spring from the hand, 2-3 are on their own.
constexpr char kTwoLines[] = R"(
  <body name="a"><joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1" contype="0"
                                                          conaffinity="0"/></body>
  <body name="b" pos="0 0 3"><joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1"
                                                          contype="0" conaffinity="0"/></body>
  <body name="c" pos="0.1 0 3"><joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1"
                                                          contype="0" conaffinity="0"/></body>
  </worldbody>
  <deformable><flex name="lines" dim="1" body="hand a b c" element="0 1 2 3">
    <edge stiffness="10"/></flex></deformable>
  <worldbody>)";

class RecordSceneTest : public SceneTest {
 protected:
  std::string SheetScene() const { return WriteScene(Scene(kSheet, kTwoTies, kLift)); }

  std::string TwoLinesScene() const {
    std::string scene = Scene(kTwoLines, "", kLift);
    scene.replace(scene.find("discrete"), 8, "Euler");  // edge stiffness wants it
    return WriteScene(scene);
  }

  // The message of the Error, which must be one line that begins with the scene's path.
  static std::string ErrorOf(const std::string& path, const RecordOptions& options = {}) {
    try {
      RecordScene(path, options);
    } catch (const Error& error) {
      std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.find(path), 0u) << message;
      return message;
    }
    ADD_FAILURE() << "no Error";
    return "";
  }

  void ExpectRefused(const std::string& mjcf, const std::string& reason) const {
    const std::string message = ErrorOf(WriteScene(mjcf));
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_ROLLOUT_RECORD_SCENE_H_
