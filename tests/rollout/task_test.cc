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
  EXPECT_THAT(Message("\"from_frame\": 19", "\"from_frame\": 2147483647"),
              HasSubstr("do not fit into 20 frames"));
}

}  // namespace
}  // namespace physpring
