// SPDX-License-Identifier: Apache-2.0
#include "rollout/task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "rollout/plugin_library.h"
#include "rollout/task_model.h"
#include "tests/support/small_task.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

using testing::HasSubstr;

class TaskTest : public testing::Test {
 protected:
  // What reading and compiling the task with this change says.
  std::string Message(const std::string& from, const std::string& to) {
    LoadPluginLibrary(PHYSPRING_PLUGIN);
    task_.Change(from, to);
    try {
      const Task task = ReadTask(task_.path());
      std::vector<std::string> warnings;
      MakeTaskModel(task, 0, &warnings);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  SmallTask task_;
};

TEST_F(TaskTest, IsReadWithItsUnits) {
  const Task task = ReadTask(task_.path());
  EXPECT_EQ(task.name, "push");
  EXPECT_EQ(task.levels.size(), 3u);
  EXPECT_NEAR(task.starts.yaw[1], 5 * std::acos(-1.0) / 180, 1e-15);
  EXPECT_EQ(task.success.at_least, 2);
  EXPECT_EQ(task.width, 64);
}

TEST_F(TaskTest, SceneOfEachLevelHasAWholeNumberOfStepsAFrame) {
  LoadPluginLibrary(PHYSPRING_PLUGIN);
  const Task task = ReadTask(task_.path());
  for (int level = 0; level < 3; ++level) {
    std::vector<std::string> warnings;
    const TaskModel model = MakeTaskModel(task, level, &warnings);
    EXPECT_EQ(warnings, std::vector<std::string>());
    EXPECT_EQ(model.node_count(), 40 >> level);
    EXPECT_EQ(model.steps, 17);  // of 1.96 ms, for 2 ms asked
    EXPECT_NEAR(model.steps * model.model->opt.timestep * 30, 1, 1e-12);
  }
}

TEST_F(TaskTest, UnknownKeysAreRefused) {
  EXPECT_THAT(Message("\"settle\"", "\"setle\""), HasSubstr("key 'setle' is not known"));
}

TEST_F(TaskTest, MissingBodiesAreNamed) {
  EXPECT_THAT(Message("\"target\": \"target\"", "\"target\": \"nobody\""),
              HasSubstr("the scene has no body 'nobody'"));
}

TEST_F(TaskTest, TargetMustBeAMocapBody) {
  EXPECT_THAT(Message("\"target\": \"target\"", "\"target\": \"marker\""),
              HasSubstr("'marker' is not a mocap body"));
}

TEST_F(TaskTest, LevelsMustBeOfTheTwin) {
  EXPECT_THAT(Message("\"level0.xml\", \"level1.xml\"", "\"level1.xml\", \"level1.xml\""),
              HasSubstr("has 20 nodes, but level 0 of the twin has 40"));
}

std::string Zeros(int count) {
  std::string list = "[0";
  for (int i = 1; i < count; ++i) list += ",0";
  return list + "]";
}

// 2^11 x 2^10 x 2^11 cells are 2^32: none, in 32 bits.
TEST_F(TaskTest, CellsAreCountedBeforeTheyAreUsed) {
  EXPECT_THAT(Message(R"({"x": [-0.01, 0.01], "yaw": [-5, 5])", R"({"x": )" + Zeros(2048) +
                                                                    R"(, "y": )" + Zeros(1024) +
                                                                    R"(, "yaw": )" + Zeros(2048)),
              HasSubstr("task.json: key 'starts' has 4294967296 cells, expected at most 1000000"));
}

TEST_F(TaskTest, NumbersHaveBounds) {
  const std::vector<std::array<const char*, 3>> cases{
      {R"("settle": 5)", R"("settle": 2147483647)", "key 'settle' holds 2147483647, expected 0 to"},
      {R"("settle": 5)", R"("settle": 5, "rate": 1e300)", "key 'rate' holds 1e+300, expected 0.1"},
      {R"("settle": 5)", R"("settle": 5, "rate": 1e-9)", "key 'rate' holds 1e-09, expected 0.1"},
      {R"("frames": 20)", R"("frames": 100001)", "key 'frames' holds 100001, expected 1 to 100000"},
      {R"("frames": 20)", R"("frames": 0)", "key 'frames' holds 0, expected 1 to 100000"},
      {R"([0, 0, 0.006])", R"([0, 0, 1e155])", "'object.position' holds 1e+155, expected numbers"},
      {R"("hand": "hand")", R"("hand": "hand", "speed": 1e300)",
       "'robot.speed' holds 1e+300, expected more than 0, at most 1000"},
      {R"("hand": "hand")", R"("hand": "hand", "home": [0, 0, 0, 1, 0, 0, 0, -1e9])",
       "'robot.home' holds -1000000000, expected numbers from -1000000 to 1000000"},
      {R"("x": [-0.01, 0.01])", R"("x": [1e300])", "'starts.x' holds 1e+300, expected numbers"},
      {R"("yaw": [-5, 5])", R"("yaw": [1e9])", "'starts.yaw' holds 1000000000, expected numbers"},
      {R"("noise_xy": 0.002)", R"("noise_xy": 1e300)", "holds 1e+300, expected 0 to 1000"},
      {R"("noise_yaw": 1)", R"("noise_yaw": -1)", "holds -1, expected 0 to 360"},
      {R"("at_least": 2)", R"("at_least": 21)", "'success.at_least' holds 21, expected 1 to 20"},
      {R"("size": [1, 0.1, 1])", R"("size": [1, 1e300, 1])", "'box.size' holds 1e+300, expected"},
      {R"("fraction": 0.5)", R"("fraction": 1.5)", "holds 1.5, expected more than 0, at most 1"},
  };
  for (const auto& [from, to, message] : cases) {
    task_.Change(from, to);
    EXPECT_THAT(Message(to, to), HasSubstr(message));
    task_.Change(to, from);
  }
}

TEST_F(TaskTest, FilesAreRelativeAndPlain) {
  for (const char* name : {"/block.twin.npz", "", R"(a\nb.npz)", R"(a\u001b[2Jb.npz)"}) {
    const std::string named = "\"twin\": \"" + std::string(name) + "\"";
    EXPECT_THAT(Message(R"("twin": "block.twin.npz")", named),
                HasSubstr("key 'twin' holds '" + std::string(*name == 'a' ? "a?" : name)));
    task_.Change(named, R"("twin": "block.twin.npz")");
  }
  EXPECT_THAT(
      Message("level0.xml", "/level0.xml"),
      HasSubstr("key 'levels' holds '/level0.xml', expected a file relative to the folder"));
}

// A step of the scene is so short that their number in a frame fits no int.
TEST_F(TaskTest, StepsOfAFrameHaveABound) {
  const std::string scene = task_.File("scene.xml");
  std::string text = ReadFile(scene);
  const std::size_t place = text.find("0.002");
  ASSERT_NE(place, std::string::npos);
  WriteFileAtomically(scene, text.replace(place, 5, "1e-12"));
  EXPECT_THAT(Message("push", "push"), HasSubstr("gives 33333333334 steps in a frame"));
}

TEST_F(TaskTest, SuccessMustFitIntoTheEpisode) {
  EXPECT_THAT(Message("\"from_frame\": 10", "\"from_frame\": 19"),
              HasSubstr("do not fit into 20 frames"));
  EXPECT_THAT(Message("\"from_frame\": 19", "\"from_frame\": 9999999"),
              HasSubstr("do not fit into 20 frames"));
}

}  // namespace
}  // namespace physpring
