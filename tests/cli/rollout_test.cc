// SPDX-License-Identifier: Apache-2.0
// physpring rollout and merge, as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/running_program.h"
#include "tests/support/small_task.h"
#include "tests/support/small_twin.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class RolloutTest : public testing::Test {
 protected:
  // `physpring rollout` on the small task with these arguments more.
  std::vector<std::string> Command(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"rollout", task_.path()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  ProgramResult Run(const std::vector<std::string>& more) const {
    return RunProgram(Command(more));
  }
  std::string File(const std::string& name) const { return folder_.File(name); }

  // The verdicts of finished episodes and what belongs to them, by name; no timing.
  std::map<std::string, std::string> Finished(const std::string& name) const {
    std::map<std::string, std::string> files;
    if (!fs::exists(File(name) + "/level0")) return files;
    for (const auto& entry : fs::directory_iterator(File(name) + "/level0")) {
      const std::string path = entry.path().string();
      if (!path.ends_with(".json") || path.ends_with(".seconds.json")) continue;
      files[entry.path().filename()] =
          ReadFile(path) + ReadFile(path.substr(0, path.size() - 5) + ".npz");
    }
    return files;
  }

  SmallTask task_;
  TemporaryFolder folder_;
};

TEST_F(RolloutTest, ReportsLevelsOnTheSameEpisodes) {
  const ProgramResult result = Run({"--policy", "replay:" + task_.WriteActions(0.1, 15), "--level",
                                    "0,2", "--episodes", "3", "--json", File("report.json")});
  ASSERT_EQ(result.status, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("agreement 100.0 %"));
  const json report = json::parse(ReadFile(File("report.json")))["policies"][0];
  EXPECT_EQ(report["levels"].size(), 2u);
  EXPECT_EQ(report["levels"][1]["level"], 2);
  EXPECT_EQ(report["levels"][1]["successes"], 3);
  EXPECT_GT(report["levels"][0]["seconds_per_episode"]["physics"], 0);
  EXPECT_EQ(report["comparisons"][0]["both"], 3);
  EXPECT_TRUE(report["comparisons"][0]["kappa"].is_null());
  EXPECT_EQ(report["episodes"].size(), 6u);
}

TEST_F(RolloutTest, MergesShardsIntoTheWhole) {
  const std::vector<std::string> whole = {"--policy", "random", "--episodes", "5"};
  for (const std::string shard : {"1/2", "2/2"}) {
    std::vector<std::string> command = whole;
    command.insert(command.end(), {"--shard", shard, "-o", File("part" + shard.substr(0, 1))});
    ASSERT_EQ(Run(command).status, 0);
  }
  const ProgramResult merged =
      RunProgram({"merge", File("part1"), File("part2"), "--json", File("merged.json")});
  ASSERT_EQ(merged.status, 0) << merged.errors;
  std::vector<std::string> command = whole;
  command.insert(command.end(), {"--json", File("whole.json")});
  ASSERT_EQ(Run(command).status, 0);
  const auto episodes = [&](const std::string& name) {
    return json::parse(ReadFile(File(name)))["policies"][0]["episodes"];
  };
  EXPECT_EQ(episodes("merged.json").size(), 5u);
  EXPECT_EQ(episodes("merged.json"), episodes("whole.json"));
}

TEST_F(RolloutTest, ComparesHowLevelsRankPolicies) {
  const std::string push = "replay:" + task_.WriteActions(0.1, 15);
  ASSERT_EQ(Run({"--policy", push, "--level", "0,1", "-o", File("a")}).status, 0);
  ASSERT_EQ(Run({"--policy", "random", "--level", "0,1", "-o", File("b")}).status, 0);
  const ProgramResult merged = RunProgram({"merge", File("a"), File("b")});
  EXPECT_THAT(merged.output, HasSubstr("level 1 ranks 2 policies against level 0: MMRV 0.000"));
}

TEST_F(RolloutTest, LosesNoFinishedEpisodeHoweverOftenItIsKilled) {
  const std::vector<std::string> options = {"--policy", "random", "--episodes", "60", "-o"};
  std::vector<std::string> killed = options, whole = options;
  killed.push_back(File("killed"));
  whole.push_back(File("whole"));
  std::mt19937 random(1);
  std::map<std::string, std::string> before;
  unsigned longest = 250;  // ms that a program lives; more where none gets to its first episode
  for (int kill = 0; kill < 20; ++kill) {
    RunningProgram program(Command(killed), File("output"));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % longest));
    program.Signal(SIGKILL);
    program.Wait();
    const auto after = Finished("killed");
    for (const auto& [name, bytes] : before) {
      ASSERT_TRUE(after.contains(name)) << name;
      EXPECT_EQ(after.at(name), bytes) << name;
    }
    before = after;
    if (before.empty()) longest += longest / 2;
  }
  EXPECT_FALSE(before.empty());  // else nothing was put at risk
  ASSERT_EQ(Run(killed).status, 0);
  ASSERT_EQ(Run(whole).status, 0);
  EXPECT_EQ(Finished("killed").size(), 60u);
  EXPECT_EQ(Finished("killed"), Finished("whole"));
}

TEST_F(RolloutTest, WhatIsOfAVideoNeedsOne) {
  for (const std::string option : {"--cameras", "--films"}) {
    const ProgramResult result = Run({"--policy", "random", option, "2"});
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.errors, HasSubstr(option + " requires --video"));
  }
}

TEST_F(RolloutTest, WritesAVideo) {
  if (std::system("command -v ffprobe >/dev/null") != 0) GTEST_SKIP() << "no ffmpeg here";
  const ProgramResult result =
      Run({"--policy", "random", "--cameras", "front,top", "--video", File("film.mp4")});
  ASSERT_EQ(result.status, 0) << result.errors;
  const std::string probe =
      "ffprobe -v error -count_frames -select_streams v:0 -show_entries "
      "stream=width,height,nb_read_frames -of csv=p=0 " +
      File("film.mp4") + " >" + File("probe.txt");
  ASSERT_EQ(std::system(probe.c_str()), 0);
  EXPECT_EQ(ReadFile(File("probe.txt")), "128,48,20\n");
}

TEST_F(RolloutTest, MovesAnExportedTwinAsInARecording) {
  const Twin twin = SmallTwin(2);
  WriteTwin(twin, File("block.twin.npz"));
  WriteRecording(RecordingOfMotion(twin, 8), File("block.npz"));
  ASSERT_EQ(RunProgram({"export", File("block.twin.npz"), "-o", File("block"), "--contact", "none"})
                .status,
            0);
  for (const int level : {0, 1}) {
    const std::string scene = File(level == 0 ? "block/scene.xml" : "block/scene_level1.xml");
    const ProgramResult result =
        RunProgram({"replay", scene, "--controllers", File("block.npz"), "--twin",
                    File("block.twin.npz"), "--json", File("replay.json")});
    ASSERT_EQ(result.status, 0) << result.errors;
    const json report = json::parse(ReadFile(File("replay.json")));
    EXPECT_EQ(report["level"], level);
    EXPECT_EQ(report["frames"], 8);
    const double motionless = report["motionless"]["track"];
    EXPECT_GT(motionless, 5e-3);
    EXPECT_LT(report["errors"]["track"], level == 0 ? 1e-6 : motionless);
  }
  EXPECT_TRUE(FailsWith(RunProgram({"replay", File("block/scene.xml"), "--controllers", "no.npz"}),
                        "no.npz: cannot be read"));
  EXPECT_EQ(RunProgram({"replay", "x.xml", "--controllers", "a.npz", "--level", "1"}).status, 2);
  EXPECT_EQ(RunProgram({"replay", "x.xml"}).status, 2);
  // as it was called once
  const ProgramResult old =
      RunProgram({"rollout", File("block/scene.xml"), "--controllers", File("block.npz")});
  EXPECT_EQ(old.status, 0) << old.errors;
  EXPECT_NE(old.errors.find("is now physpring replay"), std::string::npos) << old.errors;
}

TEST_F(RolloutTest, SaysWhatIsWrong) {
  EXPECT_TRUE(FailsWith(Run({}), "key 'policy' holds"));  // the task names no scripted one
  EXPECT_TRUE(FailsWith(Run({"--policy", "random", "--level", "3"}), "has levels 0 to 2, not 3"));
  EXPECT_TRUE(FailsWith(Run({"--policy", "replay:nothing.npz"}), "nothing.npz: cannot be read"));
  EXPECT_TRUE(FailsWith(RunProgram({"rollout", folder_.path()}), "task.json: cannot be read"));
  EXPECT_TRUE(FailsWith(RunProgram({"merge", folder_.path()}), "sweep.json: cannot be read"));
  EXPECT_TRUE(FailsWith(Run({"--policy", "random", "--level", "1,0,1"}), "1 is given twice"));
  EXPECT_TRUE(FailsWith(Run({"--policy", "random", "--save-scene", task_.path() + "/scene.xml"}),
                        "scene.xml"));
  EXPECT_EQ(Run({"--shard", "4/3"}).status, 2);
  EXPECT_EQ(Run({"--policy", "luck"}).status, 2);
}

TEST_F(RolloutTest, LeavesTheTasksFilesAlone) {
  const std::string before = ReadFile(task_.path() + "/scene.xml");
  Run({"--policy", "random", "--save-scene", task_.path() + "/scene.xml"});
  EXPECT_EQ(ReadFile(task_.path() + "/scene.xml"), before);
}

TEST_F(RolloutTest, IsNoVerdictWithoutAServer) {
  const ProgramResult result =
      Run({"--policy", "ws://127.0.0.1:1", "--episodes", "2", "--server-wait", "0"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, Not(HasSubstr("0 of 2")));
  EXPECT_THAT(result.errors, HasSubstr("Connection refused"));
  EXPECT_THAT(result.errors, HasSubstr("episode 0 is not judged"));
}

TEST_F(RolloutTest, ComparesNothingWhereNoEpisodeIsInCommon) {
  const std::string push = "replay:" + task_.WriteActions(0.1, 15);
  ASSERT_EQ(Run({"--policy", push, "-o", File("a")}).status, 0);
  ASSERT_EQ(Run({"--policy", "random", "--first", "1", "-o", File("b")}).status, 0);
  const ProgramResult merged =
      RunProgram({"merge", File("a"), File("b"), "--json", File("merged.json")});
  EXPECT_THAT(merged.output, HasSubstr("no episode in common"));
  EXPECT_THAT(ReadFile(File("merged.json")), HasSubstr("\"agreement\": null"));
}

TEST_F(RolloutTest, SaysThatFfmpegIsMissing) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const ProgramResult result = Run({"--policy", "random", "--video", File("film.mp4")});
  setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(FailsWith(result, "videos need ffmpeg")) << result.errors;
}

}  // namespace
}  // namespace physpring
