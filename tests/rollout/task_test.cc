// SPDX-License-Identifier: Apache-2.0
#include "rollout/task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rollout/plugin_library.h"
#include "rollout/task_model.h"
#include "tests/support/small_task.h"
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

TEST_F(TaskTest, NumbersOutOfReachAreRefused) {
  EXPECT_THAT(Message("\"settle\": 5", "\"settle\": 2147483647"),
              HasSubstr("key 'settle' must be 10000000 or less"));
}

TEST_F(TaskTest, RatesOutOfReachAreRefused) {
  EXPECT_THAT(Message("\"settle\": 5", "\"settle\": 5, \"rate\": 1e300"),
              HasSubstr("key 'rate' must be 10000 Hz or less"));
}

// 2^16 x 2^16 cells: their number as an int is 0.
TEST_F(TaskTest, StartsMoreThanCanBeCountedAreRefused) {
  std::string many = "[0";
  for (int i = 1; i < 1 << 16; ++i) many += ",0";
  many += "]";
  EXPECT_THAT(Message("\"x\": [-0.01, 0.01]", "\"x\": " + many + ", \"y\": " + many),
              HasSubstr("makes 8.59e+09 cells, expected 1000000 or fewer"));
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

TEST_F(TaskTest, SuccessMustFitIntoTheEpisode) {
  EXPECT_THAT(Message("\"from_frame\": 10", "\"from_frame\": 19"),
              HasSubstr("do not fit into 20 frames"));
  EXPECT_THAT(Message("\"from_frame\": 19", "\"from_frame\": 9999999"),
              HasSubstr("do not fit into 20 frames"));
}

}  // namespace
}  // namespace physpring
