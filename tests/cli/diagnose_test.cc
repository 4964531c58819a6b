// SPDX-License-Identifier: Apache-2.0
// `physpring diagnose` as a user sees it: what it refuses before the work, and that it can be
// stopped anywhere.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/running_program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/npz.h"

namespace physpring {
namespace {

class Diagnose : public testing::Test {
 protected:
  Diagnose() {
    const Twin twin = SmallTwin(1);
    WriteTwin(twin, twin_);
    WriteRecording(RecordingOfMotion(twin, 10), swing_);
    WriteRecording(RecordingOfMotion(twin, 12), held_);
  }

  ProgramResult Run(const std::string& output, const std::string& json = "") {
    std::vector<std::string> words = {"diagnose", twin_, swing_, "--heldout", held_, "-o", output};
    if (!json.empty()) words.insert(words.end(), {"--json", json});
    return RunProgram(words);
  }

  static void ExpectWarning(const ProgramResult& result, const std::string& warning) {
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.errors.find("warning: " + warning), std::string::npos) << result.errors;
  }

  TemporaryFolder folder_;
  std::string twin_ = folder_.File("small.twin.npz"), swing_ = folder_.File("swing.npz"),
              held_ = folder_.File("held.npz"), output_ = folder_.File("diagnosis");
};

TEST_F(Diagnose, NeverOverwritesWhatItReads) {
  for (const std::string& input : {twin_, swing_, held_}) {
    const std::string bytes = ReadFile(input);
    const ProgramResult result = Run(output_, input);
    EXPECT_TRUE(FailsWith(result, input + ": is read by this command")) << result.errors;
    EXPECT_TRUE(ReadFile(input) == bytes) << input;
  }
  const std::string bytes = ReadFile(twin_);
  const ProgramResult result = Run(folder_.path(), folder_.File("new.json"));
  EXPECT_TRUE(FailsWith(result, "small.twin.npz: is read by this command")) << result.errors;
  EXPECT_TRUE(ReadFile(twin_) == bytes);
}

TEST_F(Diagnose, FailsBeforeTheWorkWhereItCannotWrite) {
  EXPECT_TRUE(FailsWith(Run(swing_, ""), swing_ + ": cannot be made"));
  EXPECT_TRUE(FailsWith(Run(output_, folder_.File("none/report.json")),
                        "none/report.json: cannot be written: its folder is missing"));
  EXPECT_TRUE(FailsWith(Run(output_, output_ + "/report.json"), "two outputs have this name"));
}

TEST_F(Diagnose, RefusesADeepCheckpoint) {
  const std::string deep = std::string(100000, '[') + std::string(100000, ']');
  const int unfinished = 0;
  std::filesystem::create_directory(output_);
  WriteNpz({{"of", NpzArray::Text(deep)}, {"finished", NpzArray::Ints({}, &unfinished)}},
           output_ + "/checkpoint.npz");
  const ProgramResult result =
      RunProgram({"diagnose", twin_, swing_, "--heldout", held_, "-o", output_, "--resume"});
  EXPECT_TRUE(FailsWith(result, "checkpoint.npz: array 'of': is nested more than 32 deep"))
      << result.errors;
}

TEST_F(Diagnose, IsNotJudgedByWhatItFits) {
  const std::string copy = folder_.File("copy.npz");
  WriteFileAtomically(copy, ReadFile(swing_));
  for (const std::string& judged : {swing_, copy}) {
    const ProgramResult result =
        RunProgram({"diagnose", twin_, held_, swing_, "--heldout", judged, "-o", output_});
    EXPECT_TRUE(FailsWith(result, judged + ": is among the recordings to fit, too, as swing"))
        << result.errors;
    EXPECT_FALSE(std::filesystem::exists(output_));
  }
}

// A twin that was trained on a recording from before its object changed.
class DiagnoseChange : public Diagnose {
 protected:
  DiagnoseChange() {
    Twin twin = SmallTwin(1);
    WriteRecording(RecordingOfMotion(twin, 11), clean_);
    twin.trained_on = {{"clean", HashFile(clean_), 11}};
    WriteTwin(twin, twin_);
  }

  // The names of the recordings from before the change, as the report gives them.
  nlohmann::json Before(const std::vector<std::string>& more) {
    std::vector<std::string> words = {"diagnose", twin_, swing_,  "--heldout",
                                      held_,      "-o",  output_, "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.status, 0) << result.errors;
    return nlohmann::json::parse(ReadFile(output_ + "/report.json"))["recordings"]["before"];
  }

  std::string clean_ = folder_.File("clean.npz");
};

TEST_F(DiagnoseChange, FitsWhatTheTwinWasTrainedOnIfItIsThere) {
  EXPECT_EQ(Before({}), nlohmann::json({"clean"}));
  EXPECT_EQ(Before({"--no-before"}), nlohmann::json::array());
  WriteRecording(RecordingOfMotion(SmallTwin(1), 9), clean_);  // another one of that name
  EXPECT_EQ(Before({}), nlohmann::json::array());
  EXPECT_EQ(Before({"--before", clean_}), nlohmann::json({"clean"}));
}

TEST_F(DiagnoseChange, DoesNotTakeARecordingAsBeforeAndAfterTheChange) {
  for (const std::string& both : {swing_, held_}) {
    EXPECT_TRUE(FailsWith(RunProgram({"diagnose", twin_, swing_, "--heldout", held_, "--before",
                                      both, "-o", output_}),
                          both + ": is among the recordings to diagnose, too"));
  }
}

TEST_F(Diagnose, NeedsFramesToFitAndOthersToJudgeBy) {
  const std::string two = folder_.File("two.npz");
  Recording recording = RecordingOfMotion(SmallTwin(1), 3);
  recording.points.resize(2);
  recording.controllers.resize(2);
  WriteRecording(recording, two);
  EXPECT_TRUE(FailsWith(RunProgram({"diagnose", twin_, two, "-o", output_}),
                        "recording two: its points are seen in 1 of the frames to fit, 8 are the "
                        "fewest"));
}

TEST_F(Diagnose, IsNotJudgedByFramesInWhichNothingIsSeen) {
  Recording recording = RecordingOfMotion(SmallTwin(1), 12);
  for (int frame = 3; frame < 12; ++frame) {
    recording.points[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  WriteRecording(recording, held_);
  EXPECT_TRUE(FailsWith(Run(output_),
                        ": its points are seen in 2 of the frames to judge by, 5 are the fewest"));
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(Diagnose, NeedsNoiseThatCanBeMeasured) {
  Recording recording = RecordingOfMotion(SmallTwin(1), 40);
  const auto write_both = [&] {
    WriteRecording(recording, swing_);
    recording.points[2](0, 0) += 1e-3;  // the other is no copy
    WriteRecording(recording, held_);
  };
  for (Points& points : recording.points) points = recording.points[0];
  write_both();
  EXPECT_TRUE(
      FailsWith(Run(output_), "recording swing: its points neither move nor have any noise"));
  for (std::size_t frame = 1; frame < 40; frame += 2) {
    recording.points[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  write_both();
  EXPECT_TRUE(FailsWith(Run(output_),
                        "recording swing: none of its points is seen in five frames in a row"));
}

TEST_F(Diagnose, WarnsOfATwinThatIsWorseThanABodyThatDoesNotMove) {
  EXPECT_EQ(Run(output_).errors.find("does not move"), std::string::npos);
  Recording recording = RecordingOfMotion(SmallTwin(1), 12);
  for (int frame = 1; frame < 12; ++frame) {  // trembles
    recording.points[frame] = recording.points[0].array() + 1e-5 * (frame % 3);
  }
  WriteRecording(recording, held_);
  ExpectWarning(Run(folder_.File("other")),
                "the twin predicts worse than a body that does not move");
}

TEST_F(Diagnose, WarnsOfAnotherMass) {
  Recording recording = RecordingOfMotion(SmallTwin(1), 12);
  EXPECT_EQ(Run(output_).errors.find("weighs"), std::string::npos);
  recording.mass *= 2;
  WriteRecording(recording, held_);
  ExpectWarning(Run(folder_.File("other")), "recording held: says that the object weighs ");
}

TEST_F(Diagnose, OverwritesNothingUnasked) {
  for (const char* name : {"report.html", "small.twin.npz"}) {
    const std::string folder = folder_.File(std::string("with_") + name);
    std::filesystem::create_directory(folder);
    const std::string mine = folder + "/" + name;
    WriteFileAtomically(mine, "mine");
    EXPECT_TRUE(FailsWith(Run(folder), mine + ": exists; --force overwrites"));
    EXPECT_EQ(ReadFile(mine), "mine");
  }
}

// A twin that was trained on the motion of a body that weighs more on one side.
class DiagnoseAnew : public Diagnose {
 protected:
  DiagnoseAnew() {
    Twin heavy = SmallTwin(1);
    heavy.levels[0].system.mass.head(8) *= 3;
    WriteRecording(RecordingOfMotion(heavy, 10), swing_);
    WriteRecording(RecordingOfMotion(heavy, 12), held_);
    Twin twin = SmallTwin(2);
    twin.trained_on = {{"swing", HashFile(swing_), 10}};
    WriteTwin(twin, twin_);
  }

  std::vector<std::string> Words(const std::string& output,
                                 const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"diagnose", twin_, swing_, "--heldout", held_, "-o", output};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static void ExpectSameFiles(const std::string& p, const std::string& q) {
    for (const char* name : {"report.json", "report.html", "small.twin.npz"}) {
      EXPECT_TRUE(ReadFile(p + "/" + name) == ReadFile(q + "/" + name)) << name;
    }
  }

  std::string whole_ = folder_.File("whole"), printed_ = folder_.File("printed");
};

TEST_F(DiagnoseAnew, GivesTheEffectsToCoarseLevels) {
  ExpectWarning(RunProgram(Words(whole_, {})), "coarse levels have the effects, but");
  const Twin twin = ReadTwin(whole_ + "/small.twin.npz");
  ASSERT_FALSE(twin.levels[0].system.effects.empty());
  ASSERT_EQ(twin.levels[1].system.effects.size(), twin.levels[0].system.effects.size());
  EXPECT_EQ(twin.levels[1].system.effects[0].values, twin.levels[0].system.effects[0].values);
}

// Killed or interrupted at random moments, with many checkpoints, and resumed with one or two
// threads.
TEST_F(DiagnoseAnew, WritesTheSameBytesHoweverOftenItIsStopped) {
  const auto start = std::chrono::steady_clock::now();
  const ProgramResult uninterrupted = RunProgram(Words(whole_, {"--threads", "1"}));
  ASSERT_EQ(uninterrupted.status, 0) << uninterrupted.errors;
  const std::chrono::duration<double> usual = std::chrono::steady_clock::now() - start;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0.05, 0.4);
  for (int i = 0; i < 6; ++i) {
    RunningProgram program(
        Words(output_, {"--checkpoint", "0", "--resume", "--threads", i % 2 == 0 ? "1" : "2"}),
        printed_);
    std::this_thread::sleep_for(part(random) * usual);
    program.Signal(i % 3 == 2 ? SIGINT : SIGKILL);
    program.Wait();
    const std::string checkpoint = output_ + "/checkpoint.npz";
    if (std::filesystem::exists(checkpoint)) ReadNpz(checkpoint);  // throws if it is not whole
  }
  const ProgramResult result = RunProgram(Words(output_, {"--resume"}));
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_EQ(result.output, uninterrupted.output);
  ExpectSameFiles(whole_, output_);
  // the test is of all kinds of work: a search, and a refit of springs
  const auto report = nlohmann::json::parse(ReadFile(whole_ + "/report.json"));
  EXPECT_FALSE(report["candidates"].empty());
  EXPECT_TRUE(report["all_frames"].is_null());  // the held-out recording is never fitted
  EXPECT_TRUE(report["later_candidates"].is_array());
  EXPECT_GT(report["residual_force"]["before"]["rms_n"].get<double>(), 0);
  EXPECT_NE(ReadFile(whole_ + "/report.html").find("Mean force on each node"), std::string::npos);
}

TEST_F(DiagnoseAnew, GoesOnWithoutTheWorkThatIsDone) {
  ASSERT_EQ(RunProgram(Words(whole_, {"--checkpoint", "0"})).status, 0);
  const std::string checkpoint = whole_ + "/checkpoint.npz", bytes = ReadFile(checkpoint);
  const auto results = ReadNpz(checkpoint).at("hashes").size();
  EXPECT_EQ(RunProgram(Words(whole_, {"--resume"})).status, 0);
  EXPECT_TRUE(ReadFile(checkpoint) == bytes);
  EXPECT_GT(results, 16u * 50);  // steps and scores
}

TEST_F(DiagnoseAnew, LeavesACheckpointWhenInterrupted) {
  RunningProgram program(Words(output_, {"--checkpoint", "0", "--threads", "1"}), printed_);
  while (!std::filesystem::exists(output_ + "/checkpoint.npz")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130) << ReadFile(printed_);
  EXPECT_NE(ReadFile(printed_).find("the same command with --resume goes on from " + output_ +
                                    "/checkpoint.npz"),
            std::string::npos)
      << ReadFile(printed_);
  EXPECT_FALSE(std::filesystem::exists(output_ + "/report.json"));
  EXPECT_TRUE(FailsWith(RunProgram(Words(output_, {})),
                        output_ + ": holds an unfinished diagnosis; --resume goes on with it"));
  EXPECT_TRUE(FailsWith(RunProgram(Words(output_, {"--resume", "--seed", "5"})),
                        "checkpoint.npz: is of a diagnosis with seed 0, not 5; resume with"));
}

TEST_F(Diagnose, OverwritesAFinishedDiagnosisOnlyByForce) {
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"diagnose", twin_, swing_, "--heldout", held_, "-o", output_};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  };
  ASSERT_EQ(run({}).status, 0);
  const std::string report = output_ + "/report.json", bytes = ReadFile(report);
  std::ofstream(report) << "mine";
  EXPECT_TRUE(FailsWith(run({}), output_ + ": holds a finished diagnosis; --force makes it anew"));
  EXPECT_EQ(ReadFile(report), "mine");
  EXPECT_EQ(run({"--force"}).status, 0);
  EXPECT_TRUE(ReadFile(report) == bytes);
  std::filesystem::remove(output_ + "/checkpoint.npz");  // from an earlier version
  EXPECT_TRUE(FailsWith(run({}), output_ + ": holds a finished diagnosis"));
  EXPECT_EQ(run({"--force", "--resume"}).status, 2);
}

TEST_F(Diagnose, RefusesACheckpointThatIsNone) {
  std::filesystem::create_directories(output_);
  const std::string checkpoint = output_ + "/checkpoint.npz";
  std::ofstream(checkpoint) << "nothing";
  const auto resume = [&] {
    return RunProgram({"diagnose", twin_, swing_, "-o", output_, "--resume"});
  };
  EXPECT_TRUE(FailsWith(resume(), checkpoint + ": "));
  WriteNpz({{"x", NpzArray::Text("y")}}, checkpoint);
  EXPECT_TRUE(FailsWith(resume(), checkpoint + ": is no checkpoint of a diagnosis"));
}

}  // namespace
}  // namespace physpring
