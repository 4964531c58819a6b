// SPDX-License-Identifier: Apache-2.0
// `physpring train` as a user sees it, on tiny recordings.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>

#include "tests/cli/train_program.h"
#include "tests/support/program.h"
#include "tests/support/running_program.h"
#include "tests/support/small_twin.h"
#include "tests/support/swung_rope.h"
#include "twin/twin.h"

namespace physpring {
namespace {

constexpr std::chrono::milliseconds kSoon{20};

// "a, b" of a report "time: 3 s, a 1 s, b 2 s".
std::string PartsOf(const ProgramResult& result) {
  EXPECT_EQ(result.status, 0) << result.errors;
  const std::size_t start = result.output.find("time: ");
  if (start == std::string::npos) return result.output;
  std::istringstream line(result.output.substr(start, result.output.find('\n', start) - start));
  std::string parts, part;
  std::getline(line, part, ',');  // the whole
  while (std::getline(line, part, ',')) {
    if (!parts.empty()) parts += ',';
    parts += part.substr(0, part.find_first_of("0123456789", 1) - 1);
  }
  return parts.substr(std::min<std::size_t>(1, parts.size()));
}

class TrainBy : public Train, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, TrainBy, testing::Values("full", "smooth", "two-stage"),
                         [](const auto& test) {
                           const std::string method = test.param;
                           return method == "full"     ? "Full"
                                  : method == "smooth" ? "Smooth"
                                                       : "TwoStage";
                         });

TEST_P(TrainBy, WritesATwinAndAReport) {
  const ProgramResult result = RunProgram(Short(GetParam()));
  EXPECT_EQ(result.status, 0) << result.errors;
  for (const char* part : {"level 0 with 8 nodes, ", "track error on the fit frames: ", "time: "}) {
    EXPECT_NE(result.output.find(part), std::string::npos) << part << result.output;
  }
  const Twin twin = ReadTwin(twin_);
  EXPECT_EQ(twin.name, "rope");
  EXPECT_EQ(twin.points, 8);
  EXPECT_EQ(twin.seed, 7u);
  ASSERT_EQ(twin.trained_on.size(), 2u);
  EXPECT_EQ(twin.trained_on[1].name, "other");
  EXPECT_EQ(twin.trained_on[1].hash, HashFile(other_));
  EXPECT_EQ(twin.trained_on[1].train_frames, 10);
  const auto options = nlohmann::json::parse(twin.options_json);
  EXPECT_EQ(options["method"], GetParam());
  EXPECT_EQ(options["substeps"], "auto");
}

TEST_P(TrainBy, WritesTheSameBytesForAnyNumberOfThreads) {
  const std::string one = Uninterrupted(GetParam());
  EXPECT_EQ(RunProgram(Short(GetParam()) + Words{"--threads", "2"}).status, 0);
  EXPECT_TRUE(ReadFile(twin_) == one);
}

// Killed or interrupted at random moments, with many checkpoints, and resumed with
// one or two threads.
TEST_P(TrainBy, WritesTheSameBytesHoweverOftenItIsStopped) {
  const auto start = std::chrono::steady_clock::now();
  const std::string whole = Uninterrupted(GetParam());
  const std::chrono::duration<double> usual = std::chrono::steady_clock::now() - start;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0, 0.5);
  const Words resume = Short(GetParam()) + Words{"--checkpoint", "0.01", "--resume", "--threads"};
  for (int i = 0; i < 6; ++i) {
    RunningProgram program(resume + Words{i % 2 == 0 ? "1" : "2"}, output_);
    std::this_thread::sleep_for(part(random) * usual);
    program.Signal(i % 3 == 2 ? SIGINT : SIGKILL);
    program.Wait();
    if (std::filesystem::exists(twin_)) ReadTwin(twin_);  // throws if it is not whole
  }
  const ProgramResult result = RunProgram(resume + Words{"1"});
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_TRUE(ReadFile(twin_) == whole);
}

TEST_F(Train, LeavesACheckpointWhenInterrupted) {
  const Words words = {"train",     rope_,          "-o", twin_,      "--method",
                       "two-stage", "--checkpoint", "0",  "--epochs", "1000000"};
  const auto interrupt = [&](const Words& more) {
    std::filesystem::file_time_type before{};
    if (std::filesystem::exists(twin_)) before = std::filesystem::last_write_time(twin_);
    RunningProgram program(words + more, output_);
    do {
      std::this_thread::sleep_for(kSoon);
    } while (!std::filesystem::exists(twin_) || std::filesystem::last_write_time(twin_) == before);
    program.Signal(SIGINT);
    EXPECT_EQ(program.Wait(), 130) << ReadFile(output_);
    EXPECT_NE(ReadFile(output_).find("the same command with --resume goes on from " + twin_),
              std::string::npos)
        << ReadFile(output_);
    EXPECT_NO_THROW(ReadTwin(twin_));
  };
  interrupt({});
  EXPECT_TRUE(FailsWith(RunProgram(words), twin_ + ": is an unfinished twin; --resume goes on"));
  interrupt({"--resume"});
}

TEST_F(Train, StopsOnATermination) {
  RunningProgram program({"train", rope_, "-o", twin_, "--method", "two-stage", "--checkpoint", "0",
                          "--epochs", "1000000"},
                         output_);
  while (!std::filesystem::exists(twin_)) std::this_thread::sleep_for(kSoon);
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait(), 128 + SIGTERM);
}

TEST_F(Train, SaysThatALevelNeedsMoreSubsteps) {
  const Words train = {"train", rope_, "--epochs", "3", "--neighbours", "6", "-o"};
  ASSERT_EQ(RunProgram(train + Words{twin_}).status, 0);
  const Words coarse = {folder_.File("coarse.twin.npz"),
                        "--from",
                        twin_,
                        "--levels",
                        "2",
                        "--reduction",
                        "kmeans",
                        "--network-epochs",
                        "0",
                        "--substeps",
                        "1"};
  EXPECT_TRUE(
      FailsWith(RunProgram(train + coarse), "level 1 diverges: 1 sub-steps a frame are too few"));
}

TEST_F(Train, TakesEffectsFromADiagnosedTwin) {
  const std::string diagnosed = folder_.File("diagnosed.twin.npz");
  const Words words = Short("full") + Words{"--effects", diagnosed};
  Twin other = SmallTwin(1);
  WriteTwin(other, diagnosed);
  EXPECT_TRUE(FailsWith(RunProgram(words), diagnosed + ": this twin has no effects"));
  other.levels[0].system.effects = {{"gravity_direction", Eigen::Vector2d(0.1, 0)}};
  WriteTwin(other, diagnosed);
  ASSERT_EQ(RunProgram(words).status, 0);
  const std::vector<EffectValues> effects = ReadTwin(twin_).levels[0].system.effects;
  ASSERT_EQ(effects.size(), 1u);
  EXPECT_EQ(effects[0].name, "gravity_direction");
  EXPECT_EQ(effects[0].values, Eigen::VectorXd(Eigen::Vector2d(0.1, 0)));
  const ProgramResult without = RunProgram(Short("full") + Words{"--resume"});
  EXPECT_TRUE(FailsWith(without, ": was trained with effects [{\"name\"")) << without.errors;
}

TEST_F(Train, WarnsOfAControllerThatNoSpringJoins) {
  Recording recording = MovingRope(8, 5);
  recording.start.conservativeResize(3, 10);
  recording.start.col(9) << 0, 0, 1;
  recording.rest = recording.start;
  for (Points& controllers : recording.controllers) {
    controllers.conservativeResize(3, 2);
    controllers.col(1) = recording.start.col(9);
  }
  WriteRecording(recording, rope_);
  const ProgramResult result =
      RunProgram({"train", rope_, "-o", twin_, "--method", "two-stage", "--epochs", "1"});
  EXPECT_EQ(result.status, 0) << result.errors;
  const std::string warning =
      "warning: recording rope: controller 1 is joined to no particle, the nearest is 1 m away; it "
      "moves nothing\n";
  const auto found = result.errors.find(warning);
  EXPECT_NE(found, std::string::npos) << result.errors;
  EXPECT_EQ(result.errors.find(": controller ", found + warning.size()), std::string::npos);
  EXPECT_EQ(ReadTwin(twin_).levels[0].system.UnjoinedControllers(), std::vector<int>{1});
}

TEST_F(Train, WarnsOfAnotherRestShape) {
  Recording rope = MovingRope(8, 10);
  rope.rest = rope.start;
  rope.rest.row(0).array() += 1;  // the same shape elsewhere
  rope.rest_given = true;
  EXPECT_EQ(TrainWithOther(rope).errors.find("rest shape"), std::string::npos);
  rope.rest *= 1.1;
  const ProgramResult result = TrainWithOther(rope);
  EXPECT_NE(result.errors.find("warning: recording other: its rest shape is not that of rope, by "
                               "which training goes (frame 0)\n"),
            std::string::npos)
      << result.errors;
}

TEST_F(Train, WarnsOfAnotherRod) {
  EXPECT_EQ(RunProgram(Short("two-stage")).errors.find("training goes by"), std::string::npos);
  Recording rope = MovingRope(8, 10);
  rope.rod = PlainRod(Eigen::VectorXd::LinSpaced(rope.rest.cols(), 0, 0.3));
  const ProgramResult result = TrainWithOther(rope);
  EXPECT_NE(result.errors.find("warning: recording other: has another rod; training goes by rope, "
                               "which has none"),
            std::string::npos)
      << result.errors;
}

// The report names what took the time: no step that did nothing is a part of it.
TEST_F(Train, ReportsWhereTheTimeWent) {
  const Words levels{"--levels",    "2",      "--ratios",         "0.5",
                     "--reduction", "random", "--network-epochs", "0"};
  const std::string coarse =
      "reduction, common factors of coarse levels, single springs of coarse levels, writing "
      "checkpoints";
  EXPECT_EQ(PartsOf(RunProgram(Short("full") + levels)),
            "choosing the model, common factors, single springs (Gauss-Newton), single springs "
            "(Adam), posterior, " +
                coarse);
  const std::string from = folder_.File("from.twin.npz");
  std::filesystem::rename(twin_, from);
  EXPECT_EQ(PartsOf(RunProgram(Short("full") + levels + Words{"--from", from})), coarse);
}

TEST_F(Train, FitsCommonFactorsOfTheOnlyModel) {
  const Words only{"train",        rope_,      "-o",
                   twin_,          "--epochs", "3",
                   "--neighbours", "6",        "--controller-velocity",
                   "on",           "--cone",   "elliptic"};
  EXPECT_TRUE(
      PartsOf(RunProgram(only)).starts_with("choosing the model, common factors, single springs"));
}

TEST_F(Train, LogsEveryStep) {
  const std::string log = folder_.File("log");
  ASSERT_EQ(RunProgram(Short("two-stage") + Words{"--log", log}).status, 0);
  const std::string text = ReadFile(log);
  EXPECT_NE(text.find("search, generation 20 of 20, candidate 11 of 11: loss"), std::string::npos);
  EXPECT_NE(text.find("single springs, pass 29 of 30: loss"), std::string::npos);
}

}  // namespace
}  // namespace physpring
