// SPDX-License-Identifier: Apache-2.0
// `physpring eval` as a user sees it, on a small twin and its own motion.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/film_triple.h"
#include "tests/support/program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/evaluate.h"
#include "twin/npz.h"

namespace physpring {
namespace {

using Json = nlohmann::json;

constexpr int kFrames = 20;

class Eval : public testing::Test {
 protected:
  Eval() {
    twin_ = SmallTwin(2);
    recording_ = RecordingOfMotion(twin_, kFrames);
    WriteRecording(recording_, swing_);
    WriteTwin(twin_, path_);
  }

  // The twin again, as trained on the first 14 frames of the recording.
  void TrainOnSwing() {
    twin_.trained_on.push_back({"swing", ReadRecording(swing_).hash, 14});
    WriteTwin(twin_, path_);
  }

  Json EvalToJson(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"eval", path_});
    arguments.insert(arguments.end(), {"--json", folder_.File("eval.json")});
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.status, 0) << result.errors;
    return Json::parse(ReadFile(folder_.File("eval.json")));
  }

  TemporaryFolder folder_;
  std::string swing_ = folder_.File("swing.npz"), path_ = folder_.File("block.twin.npz");
  Twin twin_;
  Recording recording_;
};

TEST_F(Eval, PrintsATable) {
  const ProgramResult result = RunProgram({"eval", path_, swing_});
  EXPECT_EQ(result.status, 0);
  for (const char* part : {"2 levels, double precision", "swing.npz: 20 frames at 50 fps",
                           "level 0", "level 1", "motionless", "rigid"}) {
    EXPECT_NE(result.output.find(part), std::string::npos) << part;
  }
}

TEST_F(Eval, WritesOverNothingThatItReads) {
  const std::string twin = ReadFile(path_), swing = ReadFile(swing_);
  const std::string json = folder_.File("a.json");
  const std::vector<std::vector<std::string>> bad{{"--json", swing_},
                                                  {"--json", path_},
                                                  {"--trajectory", swing_},
                                                  {"--json", json, "--trajectory", json},
                                                  {"--json", folder_.File("missing/a.json")},
                                                  {"--json", "/proc/a.json"}};
  for (const std::vector<std::string>& flags : bad) {
    std::vector<std::string> arguments{"eval", path_, swing_};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.status, 1) << flags[1];
    EXPECT_EQ(result.output, "") << flags[1];
    EXPECT_EQ(result.errors.find("physpring: " + flags.back() + ": "), 0u) << result.errors;
  }
  EXPECT_EQ(ReadFile(path_), twin);
  EXPECT_EQ(ReadFile(swing_), swing);
}

TEST_F(Eval, TellsTwinsFromRecordings) {
  EXPECT_EQ(RunProgram({"eval", swing_, swing_}).errors,
            "physpring: " + swing_ + ": is a recording, not a twin\n");
  EXPECT_EQ(RunProgram({"eval", path_, path_}).errors,
            "physpring: " + path_ + ": is a twin, not a recording\n");
}

TEST_F(Eval, WarnsOfATwinThatIsWorseThanNothing) {
  for (Points& frame : recording_.points) frame = recording_.points[0];
  WriteRecording(recording_, swing_);
  const std::string errors = RunProgram({"eval", path_, swing_}).errors;
  EXPECT_NE(errors.find("nothing moves: points stay within 0 m"), std::string::npos) << errors;
  for (int level : {0, 1}) {
    const std::string line = "a body that does not move predicts this better than level ";
    EXPECT_NE(errors.find(line + std::to_string(level)), std::string::npos) << errors;
  }
}

TEST_F(Eval, WarnsOfAnUnfinishedTwin) {
  const int no = 0;
  twin_.training_state["train/finished"] = NpzArray::Ints({}, &no);
  WriteTwin(twin_, path_);
  EXPECT_EQ(RunProgram({"eval", path_, swing_}).errors.find("warning: " + path_ + ": its training"),
            0u);
}

TEST_F(Eval, WritesTheDocumentedJson) {
  const Json json = EvalToJson({swing_});
  ASSERT_EQ(json["levels"].size(), 2u);
  for (const Json& where : {json, json["recordings"][0]}) {
    const Json& level = where["levels"][1];
    EXPECT_EQ(level["level"], 1);
    EXPECT_EQ(level["nodes"], 20);
    EXPECT_EQ(level["springs"], twin_.levels[1].system.spring_count());
    EXPECT_GT(level["substeps"], 0);
    EXPECT_GT(level["fps"], 0);
    EXPECT_TRUE(level["fit"].is_null());
    for (const char* key : {"cd", "track", "cd_lifted", "track_lifted"}) {
      EXPECT_TRUE(level["prediction"][key].is_number_float()) << key;
    }
    EXPECT_EQ(level["prediction"]["frames"]["track"], kFrames - 1);
    EXPECT_FALSE(level.contains("published_l1"));
    EXPECT_TRUE(where["motionless"]["prediction"]["track"].is_number_float());
  }
  EXPECT_EQ(json["recordings"][0]["file"], swing_);
}

TEST_F(Eval, GivesTheLibrarysErrorsInMetres) {
  const Json json = EvalToJson({swing_});
  const RecordingResult expected = Evaluate(twin_, ReadRecording(swing_), {});
  const Json& prediction = json["levels"][1]["prediction"];
  const auto mean = [](const std::vector<double>& errors) {
    return MeanOverFrames(errors, 1, kFrames).value.value();
  };
  EXPECT_EQ(prediction["cd"], mean(expected.levels[1].direct.cd));
  EXPECT_EQ(prediction["track"], mean(expected.levels[1].direct.track));
  EXPECT_EQ(prediction["cd_lifted"], mean(expected.levels[1].lifted.cd));
  EXPECT_EQ(prediction["track_lifted"], mean(expected.levels[1].lifted.track));
  // the recording is level 0's own motion, stored in float32
  EXPECT_LT(json["levels"][0]["prediction"]["track"], 1e-6);
  EXPECT_EQ(json["motionless"]["prediction"]["track"], mean(expected.baselines[0].errors.track));
}

TEST_F(Eval, SplitsTheRecordingItWasTrainedOn) {
  TrainOnSwing();
  const Json level = EvalToJson({swing_})["levels"][1];
  EXPECT_EQ(level["fit"]["frames"]["track"], 13);        // 1 .. 13
  EXPECT_EQ(level["prediction"]["frames"]["track"], 6);  // 14 .. 19
  const RecordingResult expected = Evaluate(twin_, ReadRecording(swing_), {});
  const std::vector<double>& track = expected.levels[1].direct.track;
  EXPECT_EQ(level["fit"]["track"], MeanOverFrames(track, 1, 14).value.value());
  EXPECT_EQ(level["prediction"]["track"], MeanOverFrames(track, 14, kFrames).value.value());
}

TEST_F(Eval, AveragesRecordingsNotFrames) {
  Recording shorter = RecordingOfMotion(twin_, 5);
  WriteRecording(shorter, folder_.File("short.npz"));
  const Json json = EvalToJson({swing_, folder_.File("short.npz")});
  const auto track = [](const Json& where) -> double {
    return where["motionless"]["prediction"]["track"];
  };
  EXPECT_DOUBLE_EQ(track(json), (track(json["recordings"][0]) + track(json["recordings"][1])) / 2);
  EXPECT_EQ(json["levels"][0]["prediction"]["frames"]["track"], 19 + 4);
}

TEST_F(Eval, LeavesFramesWithoutDataOutAndCountsThem) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (int t : {7, 8, 9}) recording_.points[t].setConstant(kNaN);
  WriteRecording(recording_, swing_);
  const Json seen_in_part = EvalToJson({swing_})["motionless"]["prediction"];
  EXPECT_EQ(seen_in_part["frames"]["track"], 16);
  EXPECT_EQ(seen_in_part["frames_without_data"]["track"], 3);

  for (int t = 1; t < kFrames; ++t) recording_.points[t].setConstant(kNaN);
  WriteRecording(recording_, swing_);
  const Json never_seen = EvalToJson({swing_})["levels"][0]["prediction"];
  EXPECT_TRUE(never_seen["track"].is_null());
  EXPECT_TRUE(never_seen["cd"].is_null());
  EXPECT_EQ(never_seen["frames_without_data"]["cd"], 19);
}

TEST_F(Eval, GivesThePublishedMeasureOfRods) {
  recording_.rod = PlainRod(Eigen::VectorXd::LinSpaced(42, 0, 1));
  WriteRecording(recording_, swing_);
  const Json json = EvalToJson({swing_});
  EXPECT_LT(json["levels"][0]["published_l1"], 1e-6);
  EXPECT_GT(json["motionless"]["published_l1"], 1e-3);
}

TEST_F(Eval, TakesTheHeldOutRecordingsOfAFolder) {
  WriteRecording(recording_, folder_.File("other.npz"));
  WriteFileAtomically(folder_.File("dataset.json"),
                      R"({"recordings": [{"file": "swing.npz", "role": "fit"},
                                         {"file": "other.npz", "role": "heldout"}]})");
  const Json json = EvalToJson({folder_.path()});
  ASSERT_EQ(json["recordings"].size(), 1u);
  EXPECT_EQ(std::filesystem::path(json["recordings"][0]["file"].get<std::string>()).filename(),
            "other.npz");
}

TEST_F(Eval, GivesTheSameErrorsOnTwoThreads) {
  WriteRecording(RecordingOfMotion(twin_, 9), folder_.File("short.npz"));
  const std::vector<std::string> files{swing_, folder_.File("short.npz")};
  const auto without_speed = [&](const char* threads) {
    Json json = EvalToJson({files[0], files[1], "--threads", threads});
    for (Json* where : {&json, &json["recordings"][0], &json["recordings"][1]}) {
      for (Json& level : (*where)["levels"]) level.erase("fps");
    }
    return json;
  };
  EXPECT_EQ(without_speed("1"), without_speed("2"));
}

TEST_F(Eval, TakesTheSubStepsAndThePrecisionItIsGiven) {
  const Json json = EvalToJson({swing_, "--substeps", "100", "--precision", "float"});
  EXPECT_EQ(json["levels"][0]["substeps"], 100);
  EXPECT_EQ(json["precision"], "float");
}

TEST_F(Eval, WritesTheMeasuredPointsAsPredicted) {
  recording_.points[3].col(5).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteRecording(recording_, swing_);
  ASSERT_EQ(RunProgram({"eval", path_, swing_, "--trajectory", folder_.File("motion.npz")}).status,
            0);
  const Npz arrays = ReadNpz(folder_.File("motion.npz"));
  ASSERT_EQ(arrays.size(), 2u);
  const RecordingResult expected = Evaluate(twin_, ReadRecording(swing_), {});
  for (const LevelResult& level : expected.levels) {
    const NpzArray& array = arrays.at("level" + std::to_string(level.level) + "/points");
    EXPECT_EQ(array.shape, (std::vector<std::size_t>{kFrames, 32, 3}));
    const std::vector<double> values = array.ToDoubles();
    for (int t = 0; t < kFrames; ++t) {
      const Eigen::Map<const Points> points(&values[t * 96], 3, 32);  // seen or not
      EXPECT_LT((points - level.points[t]).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
}

TEST_F(Eval, WritesATrajectoryForEachRecording) {
  WriteRecording(recording_, folder_.File("other.npz"));
  const std::string other = folder_.File("other.npz"), motion = folder_.File("motion");
  ASSERT_EQ(RunProgram({"eval", path_, swing_, other, "--trajectory", motion}).status, 0);
  EXPECT_EQ(ReadNpz(motion + "/swing.npz").size(), 2u);
  EXPECT_EQ(ReadNpz(motion + "/other.npz").size(), 2u);
  const ProgramResult one_file =
      RunProgram({"eval", path_, swing_, other, "--trajectory", folder_.File("one.npz")});
  EXPECT_EQ(one_file.status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.File("one.npz")));
}

TEST_F(Eval, RefusesAnotherObject) {
  const Twin other = [] {
    Twin twin = SmallTwin(1);
    twin.points = 30;
    twin.interior = 10;
    return twin;
  }();
  WriteRecording(RecordingOfMotion(other, 5), swing_);
  const ProgramResult result =
      RunProgram({"eval", path_, swing_, "--json", folder_.File("x.json")});
  EXPECT_TRUE(FailsWith(result, "30 points, but twin block has 32")) << result.errors;
  EXPECT_FALSE(std::filesystem::exists(folder_.File("x.json")));
}

TEST_F(Eval, FailsInOneLineOnBadFiles) {
  const std::string missing = folder_.File("missing.npz"), cut = folder_.File("cut.npz");
  EXPECT_TRUE(FailsWith(RunProgram({"eval", missing, swing_}), missing));
  EXPECT_TRUE(FailsWith(RunProgram({"eval", path_, missing}), missing));
  const std::string twin = ReadFile(path_), recording = ReadFile(swing_);
  WriteFileAtomically(cut, twin.substr(0, twin.size() / 2));
  EXPECT_TRUE(FailsWith(RunProgram({"eval", cut, swing_}), cut));
  WriteFileAtomically(cut, recording.substr(0, recording.size() / 2));
  EXPECT_TRUE(FailsWith(RunProgram({"eval", path_, cut}), cut));
  EXPECT_TRUE(FailsWith(RunProgram({"eval", swing_, swing_}), swing_));  // not a twin
}

TEST_F(Eval, SaysWhatHelpsAgainstDivergence) {
  Twin stiff = SmallTwin(1);
  stiff.levels[0].system.stiffness *= 1e30;
  WriteTwin(stiff, path_);
  const ProgramResult result = RunProgram({"eval", path_, swing_, "--substeps", "1"});
  EXPECT_TRUE(FailsWith(result, "more sub-steps")) << result.errors;
}

TEST_F(Eval, EndsWith2OnBadUsage) {
  EXPECT_EQ(RunProgram({"eval"}).status, 2);
  EXPECT_EQ(RunProgram({"eval", path_}).status, 2);
  EXPECT_EQ(RunProgram({"eval", path_, swing_, "--precision", "half"}).status, 2);
  EXPECT_EQ(RunProgram({"eval", path_, swing_, "--substeps", "-1"}).status, 2);
  EXPECT_EQ(RunProgram({"eval", path_, swing_, "--picture", "page.png"}).status, 2);
  EXPECT_EQ(RunProgram({"eval", path_, swing_, "--colour"}).status, 2);
}

TEST_F(Eval, WritesAPageThatNeedsNothingElse) {
  TrainOnSwing();
  const std::string page = folder_.File("page.html");
  ASSERT_EQ(RunProgram({"eval", path_, swing_, "--picture", page}).status, 0);
  const std::string html = ReadFile(page);
  for (const char* part : {"<!DOCTYPE html>", "<canvas", "<svg", "class=\"plot\"", "motionless",
                           "level 1", "</html>"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  for (const char* part : {"http:", "https:", " src=", " href=", "@import"}) {
    EXPECT_EQ(html.find(part), std::string::npos) << part;
  }
}

TEST_F(Eval, WritesNamesIntoThePageAsText) {
  twin_.name = "<script>&\"</script>";
  WriteTwin(twin_, path_);
  const std::string page = folder_.File("page.html");
  ASSERT_EQ(RunProgram({"eval", path_, swing_, "--picture", page}).status, 0);
  EXPECT_EQ(ReadFile(page).find(twin_.name), std::string::npos);
  EXPECT_NE(ReadFile(page).find("&lt;script&gt;&amp;"), std::string::npos);
}

TEST_F(Eval, ShowsTheMotionInTheFilm) {
  const std::string page = folder_.File("page.html");
  ASSERT_EQ(RunProgram({"eval", path_, swing_, "--picture", page}).status, 0);
  const std::string html = ReadFile(page), head = "id=\"film-data\">";
  const auto begin = html.find(head) + head.size();
  const Json film = Json::parse(html.substr(begin, html.find("</script>", begin) - begin))[0];
  EXPECT_EQ(film["frames"], kFrames);
  // distances are the same in the film's turned frame, up to a step for each end
  const double step = film["step"];
  const auto predicted = [&](int frame, int node) -> Eigen::Vector3d {
    return step * DecodeTriple(film["layers"][0]["positions"], frame * 40 + node);
  };
  const double expected = (recording_.points[19].col(31) - recording_.points[4].col(2)).norm();
  EXPECT_NEAR((predicted(19, 31) - predicted(4, 2)).norm(), expected, 2 * step);
  EXPECT_LT(step, 1e-5);
}

}  // namespace
}  // namespace physpring
