// SPDX-License-Identifier: Apache-2.0
// `physpring info` as a user sees it.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

using Json = nlohmann::json;

class Info : public testing::Test {
 protected:
  Json InfoToJson(const std::string& path) {
    const std::string json = folder_.File("info.json");
    const ProgramResult result = RunProgram({"info", path, "--json", json});
    EXPECT_EQ(result.status, 0) << result.errors;
    EXPECT_NE(result.output.find(path), std::string::npos);
    return Json::parse(ReadFile(json));
  }

  TemporaryFolder folder_;
};

TEST_F(Info, TellsWhatIsInARecording) {
  Recording recording = RecordingOfMotion(SmallTwin(1), 10);
  for (int i = 0; i < 16; ++i) {  // half of the points in a tenth of the frames
    recording.points[3].col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  recording.ground = Eigen::Vector4d(0, 0, 1, -0.5);
  WriteRecording(recording, folder_.File("swing.npz"));
  const Json json = InfoToJson(folder_.File("swing.npz"));
  EXPECT_EQ(json["kind"], "recording");
  EXPECT_EQ(json["frames"], 10);
  EXPECT_EQ(json["points"], 32);
  EXPECT_EQ(json["interior"], 8);
  EXPECT_EQ(json["controllers"], 2);
  EXPECT_DOUBLE_EQ(json["missing_fraction"], 0.05);
  EXPECT_DOUBLE_EQ(json["duration_s"], 9.0 / 50);
  EXPECT_DOUBLE_EQ(json["mass_kg"], recording.mass);
  EXPECT_EQ(json["ground"], (std::vector<double>{0, 0, 1, -0.5}));
  EXPECT_TRUE(json["warnings"].empty());
}

TEST_F(Info, RepeatsTheReadersWarnings) {
  Recording recording = RecordingOfMotion(SmallTwin(1), 10);
  recording.points[0].col(3).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteRecording(recording, folder_.File("swing.npz"));
  const Json json = InfoToJson(folder_.File("swing.npz"));
  ASSERT_EQ(json["warnings"].size(), 1u);
  const ProgramResult result = RunProgram({"info", folder_.File("swing.npz")});
  EXPECT_EQ(result.errors, "warning: " + json["warnings"][0].get<std::string>() + "\n");
}

TEST_F(Info, TellsWhatIsInATwin) {
  Twin twin = SmallTwin(2);
  twin.levels[0].system.stiffness[0] = 10;
  twin.levels[0].system.stiffness[1] = 90;
  twin.trained_on.push_back({"swing", "0123456789abcdef", 14});
  twin.options_json = R"({"epochs":80})";
  WriteTwin(twin, folder_.File("block.twin.npz"));
  const Json json = InfoToJson(folder_.File("block.twin.npz"));
  EXPECT_EQ(json["kind"], "twin");
  EXPECT_EQ(json["options"]["epochs"], 80);
  EXPECT_EQ(json["trained_on"][0]["train_frames"], 14);
  ASSERT_EQ(json["levels"].size(), 2u);
  const Json& level = json["levels"][0];
  EXPECT_EQ(level["nodes"], 40);
  EXPECT_EQ(level["stiffness_n_m"], (Json{{"min", 10}, {"median", 60}, {"max", 90}}));
  EXPECT_EQ(level["substeps_per_second"], 1000);
  EXPECT_NEAR(level["total_mass_kg"], 0.1, 1e-12);
  EXPECT_GT(level["stable_timestep_s"], 1e-4);
}

TEST_F(Info, NamesTheEffectsOfATwin) {
  Twin twin = SmallTwin(1);
  twin.levels[0].system.effects = {{"gravity_direction", Eigen::Vector2d(0.125, -0.5)}};
  WriteTwin(twin, folder_.File("tilted.twin.npz"));
  const Json json = InfoToJson(folder_.File("tilted.twin.npz"));
  EXPECT_EQ(json["levels"][0]["effects"][0]["name"], "gravity_direction");
  EXPECT_EQ(json["levels"][0]["effects"][0]["parameters"]["tilt_y_rad"], -0.5);
  const ProgramResult result = RunProgram({"info", folder_.File("tilted.twin.npz")});
  EXPECT_NE(result.output.find("effect gravity_direction: tilt_x_rad 0.125, tilt_y_rad -0.5\n"),
            std::string::npos)
      << result.output;
}

TEST_F(Info, FailsInOneLineOnOtherFiles) {
  const std::string path = folder_.File("file.npz");
  EXPECT_TRUE(FailsWith(RunProgram({"info", path}), path));
  WriteFileAtomically(path, "no archive");
  EXPECT_TRUE(FailsWith(RunProgram({"info", path}), path));
  const double one = 1;
  WriteNpz({{"x", NpzArray::Doubles({}, &one)}}, path);
  EXPECT_TRUE(FailsWith(RunProgram({"info", path}), "neither"));
}

TEST_F(Info, DoesNotWaitForAPipe) {
  const std::string path = folder_.File("pipe.npz");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const std::string refusal = path + ": cannot be read: is a pipe";
  EXPECT_TRUE(FailsWith(RunProgram({"info", path}), refusal));
  EXPECT_TRUE(FailsWith(RunProgram({"record", path, "-o", folder_.File("new.npz")}), refusal));
}

TEST_F(Info, EndsWith2OnBadUsage) { EXPECT_EQ(RunProgram({"info"}).status, 2); }

}  // namespace
}  // namespace physpring
