// SPDX-License-Identifier: Apache-2.0
#include "rollout/success_rule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_twin.h"
#include "twin/error.h"

namespace physpring {
namespace {

// Judges the small twin's block with a rule that has these numbers.
Task TaskWith(const std::string& rule, const std::string& numbers) {
  Task task;
  task.folder = "folder";
  task.twin = SmallTwin(1);
  task.success.rule = rule;
  task.success.numbers = numbers;
  return task;
}

// Particle (x, y, z) of the block is number (z * 4 + y) * 5 + x, at 20 mm times (x, y, z).
Points Block(const Task& task) {
  const SpringMassSystem& system = task.twin.levels[0].system;
  return system.position.leftCols(system.node_count());
}

std::string Message(const Task& task) {
  try {
    MakeSuccessRule(task);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(SpringsThrough, CountsCrossingsInsideTheRectangleOnly) {
  // faces y = 10 and 50 mm; of those springs that cross both planes inside x = 30 ... 50 mm
  const Task task = TaskWith("springs_through",
                             R"({"box": {"position": [0.04, 0.03, 0.01],
                                         "size": [0.02, 0.04, 0.1]}, "springs": 2})");
  const SpringMassSystem& system = task.twin.levels[0].system;
  const Points block = Block(task);
  const auto crossing = [&](double plane) {
    int count = 0;
    for (const auto& [a, b] : system.springs) {
      if (std::max(a, b) >= system.node_count()) continue;
      const Eigen::Vector3d from = block.col(a), to = block.col(b);
      if ((from.y() < plane) == (to.y() < plane)) continue;
      const double x = from.x() + (plane - from.y()) / (to.y() - from.y()) * (to.x() - from.x());
      count += x >= 0.03 && x <= 0.05 ? 1 : 0;
    }
    return count;
  };
  const int expected = std::min(crossing(0.01), crossing(0.05));
  ASSERT_GT(expected, 0);
  EXPECT_EQ(MakeSuccessRule(task)->Judge(block).value, expected);
}

TEST(SpringsThrough, IsNotMetOnceTheObjectIsBesideTheBox) {
  const Task task = TaskWith("springs_through",
                             R"({"box": {"position": [0.04, 0.03, 0.01],
                                         "size": [0.02, 0.04, 0.1]}, "springs": 1})");
  const auto rule = MakeSuccessRule(task);
  EXPECT_TRUE(rule->Judge(Block(task)).met);
  EXPECT_FALSE(rule->Judge(Block(task).colwise() + Eigen::Vector3d(0.2, 0, 0)).met);
}

TEST(ParticlesInside, CountsTheFractionInATurnedBox) {
  // turned by 90 degrees, x and y of the size change places: the box holds the columns x = 0, 1
  const Task task = TaskWith("particles_inside",
                             R"({"box": {"position": [0.01, 0.03, 0.01],
                                         "size": [0.1, 0.03, 0.1], "yaw": 90}, "fraction": 0.4})");
  const SuccessRule::Verdict verdict = MakeSuccessRule(task)->Judge(Block(task));
  EXPECT_NEAR(verdict.value, 2.0 / 5, 1e-15);
  EXPECT_TRUE(verdict.met);
}

TEST(NearTarget, IsTheMeanSquaredDistance) {
  const Task task = TaskWith("near_target", R"({"target": {"position": [0.03, 0, 0.04]},
                                                "mean_squared_distance": 0.002})");
  const SuccessRule::Verdict verdict = MakeSuccessRule(task)->Judge(Block(task));
  EXPECT_NEAR(verdict.value, 0.0025, 1e-12);  // 50 mm apart
  EXPECT_FALSE(verdict.met);
}

TEST(PairsClose, IsTheMeanDistance) {
  const Task task = TaskWith("pairs_close", R"({"pairs": [[0, 1], [0, 3]], "distance": 0.05})");
  const SuccessRule::Verdict verdict = MakeSuccessRule(task)->Judge(Block(task));
  EXPECT_NEAR(verdict.value, 0.04, 1e-12);  // of 20 and 60 mm
  EXPECT_TRUE(verdict.met);
}

TEST(MakeSuccessRule, RefusesWhatMakesNoSense) {
  using testing::HasSubstr;
  EXPECT_THAT(Message(TaskWith("luck", "{}")), HasSubstr("rule 'luck' is not known"));
  EXPECT_THAT(Message(TaskWith("pairs_close", R"({"pairs": [[0, 40]], "distance": 1})")),
              HasSubstr("below 40"));
  EXPECT_THAT(Message(TaskWith("pairs_close", R"({"pairs": [[0, 1]], "distance": 1, "x": 2})")),
              HasSubstr("'x' is not known"));
  EXPECT_THAT(Message(TaskWith("particles_inside",
                               R"({"box": {"position": [0, 0, 0], "size": [1, 1, 0]}})")),
              HasSubstr("'box.size' must be above 0"));
}

}  // namespace
}  // namespace physpring
