// SPDX-License-Identifier: Apache-2.0
// Pictures as a user has them: `fit-splats`, and `eval --images`, on a small twin whose splats drew
// what was "recorded".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "pictures/picture_folder.h"
#include "splats/picture_bytes.h"
#include "splats/rasterise.h"
#include "splats/splat_file.h"
#include "splats/splat_motion.h"
#include "tests/splats/random_splats.h"
#include "tests/support/program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/npz_fields.h"
#include "twin/predict.h"

namespace physpring {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

constexpr int kFrames = 6;

class Pictures : public testing::Test {
 protected:
  Pictures() : twin_(SmallTwin(2)), recording_(RecordingOfMotion(twin_, kFrames)) {
    WriteTwin(twin_, File("block.twin.npz"));
    WriteRecording(recording_, File("swing.npz"));
    nodes_ = Predict(twin_, 0, recording_, {});
    splats_ = RandomSplats(static_cast<int>(nodes_[0].cols()), 0, 1);
    splats_.position = nodes_[0].cast<float>();
    splats_.log_scale.setConstant(std::log(0.008F));
    splats_.logit.setConstant(4);
    WriteSplats(splats_, File("block.ply"));
    Draw();
  }

  std::string File(const std::string& name) const { return folder_.File(name); }

  // What a camera before the block sees of its splats as level 0 moves them.
  void Draw() const {
    RecordedCamera camera{"front", {64, 48}};
    camera.view.axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // it looks along y, z is up
    camera.view.shift =
        -camera.view.axes * (nodes_[0].rowwise().mean() - 0.4 * Eigen::Vector3d::UnitY());
    camera.view.fx = camera.view.fy = 120;
    camera.view.cx = 32;
    camera.view.cy = 24;
    const PictureFolder folder(File("seen"), recording_.fps, kFrames, 1e-4, {camera});
    folder.MakeFolders();
    const SplatMotion motion(splats_, nodes_[0]);
    for (int frame = 0; frame < kFrames; ++frame) {
      const SplatPicture picture = Rasterise(motion.At(nodes_[frame], 1), camera.view, {}, 1);
      Mask mask{64, 48, {}};
      for (const float covered : picture.coverage) {
        mask.kind.push_back(covered > 0 ? kObject : kElsewhere);
      }
      // the block is not deep: all of it is taken to be at 0.4 m
      folder.Write(0, frame, BytesOf(picture));
      folder.Write(0, frame, mask);
      folder.Write(0, frame, DepthImage{64, 48, std::vector<float>(64 * 48, 0.4F)});
    }
    folder.WriteCameras();
  }

  ProgramResult Eval(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"eval", File("block.twin.npz"), File("swing.npz")};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  }

  TemporaryFolder folder_;
  Twin twin_;
  Recording recording_;
  std::vector<Points> nodes_;
  Splats splats_;
};

TEST_F(Pictures, AnExactPredictionHasNoErrors) {
  const ProgramResult result =
      Eval({"--images", File("seen"), "--splats", File("block.ply"), "--json", File("e.json"),
            "--picture", File("e.html"), "--threads", "2"});
  ASSERT_EQ(result.status, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("IoU"));
  const Json images = Json::parse(ReadFile(File("e.json")))["recordings"][0]["images"];
  const Json exact = images["levels"][0]["prediction"];
  EXPECT_EQ(exact["pictures"], kFrames - 1);
  EXPECT_GT(exact["psnr"], 60);  // some bytes differ by 1
  EXPECT_GT(exact["box_ssim"], 0.999);
  const Json still = images["motionless"]["prediction"];
  EXPECT_LT(still["psnr"], exact["psnr"].get<double>() - 3);
  EXPECT_LT(still["iou"], exact["iou"].get<double>() - 0.02);
  const std::string page = ReadFile(File("e.html"));
  EXPECT_THAT(page, HasSubstr("recorded, frame 5"));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBOR"));
}

TEST_F(Pictures, AreOfTheRecordingsFrames) {
  const RecordedCamera camera = PictureFolder(File("seen")).cameras()[0];
  PictureFolder(File("seen"), recording_.fps, kFrames + 1, 1e-4, {camera}).WriteCameras();
  const ProgramResult result = Eval({"--images", File("seen"), "--splats", File("block.ply")});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.errors, HasSubstr("has 7 frames at 50 fps, but"));
}

TEST_F(Pictures, ThoseOfAnotherRecordingAreAWarning) {
  Recording elsewhere = recording_;
  for (Points* points : {&elsewhere.start, &elsewhere.rest, &elsewhere.interior}) {
    points->row(2).array() += 0.07;
  }
  for (Points& frame : elsewhere.points) frame.row(2).array() += 0.07;
  for (Points& frame : elsewhere.controllers) frame.row(2).array() += 0.07;
  WriteRecording(elsewhere, File("swing.npz"));
  const ProgramResult result = Eval({"--images", File("seen"), "--splats", File("block.ply")});
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("of the measured points are where the cameras see"));
}

TEST_F(Pictures, MissingAndDamagedOnesAreOneLine) {
  std::filesystem::remove(File("seen/mask/front/00003.png"));
  const ProgramResult missing = Eval({"--images", File("seen"), "--splats", File("block.ply")});
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.errors, HasSubstr("seen/mask/front/00003.png"));
  EXPECT_EQ(Eval({"--images", File("seen")}).status, 2);  // needs --splats
  EXPECT_THAT(
      Eval({"--images", File("seen"), "--splats", File("block.ply"), "--cameras", "top"}).errors,
      HasSubstr("has no camera 'top'; it has front"));
}

TEST_F(Pictures, OtherMethodsAreJudgedBesideThem) {
  WriteNpz({{"particles", StoreFrames(nodes_)}}, File("other.npz"));
  const std::string named = "mine=" + File("other.npz");
  const ProgramResult result = Eval({"--prediction", named, "--images", File("seen"), "--splats",
                                     File("block.ply"), "--json", File("e.json")});
  ASSERT_EQ(result.status, 0) << result.errors;
  const Json json = Json::parse(ReadFile(File("e.json")))["recordings"][0];
  const Json &mine = json["mine"], level0 = json["levels"][0];
  EXPECT_NEAR(mine["prediction"]["track"], level0["prediction"]["track"].get<double>(), 1e-8);
  EXPECT_GT(json["images"]["mine"]["prediction"]["psnr"], 60);
  // one that is 3 cm too high in all frames is judged where it is
  std::vector<Points> high = nodes_;
  for (Points& frame : high) frame.row(2).array() += 0.03;
  WriteNpz({{"particles", StoreFrames(high)}}, File("high.npz"));
  ASSERT_EQ(Eval({"--prediction", "high=" + File("high.npz"), "--images", File("seen"), "--splats",
                  File("block.ply"), "--json", File("e.json")})
                .status,
            0);
  const Json judged = Json::parse(ReadFile(File("e.json")))["recordings"][0]["images"]["high"];
  EXPECT_LT(judged["prediction"]["iou"], 0.5);
  WriteNpz({{"particles", StoreFrames({nodes_[0]})}}, File("short.npz"));
  const ProgramResult cut = Eval({"--prediction", "mine=" + File("short.npz")});
  EXPECT_EQ(cut.status, 1);
  EXPECT_THAT(cut.errors, HasSubstr("short.npz"));
  for (const char* word : {"nameless.npz", "levels=a.npz", "<b>=a.npz", "=a.npz", "a="}) {
    EXPECT_EQ(Eval({"--prediction", word}).status, 2) << word;
  }
  EXPECT_EQ(Eval({"--prediction", named, "--prediction", named}).status, 2);
  EXPECT_THAT(Eval({"--prediction", named, "--json", File("other.npz")}).errors,
              HasSubstr("is read by this command"));
}

TEST_F(Pictures, FitSplatsMakesAFileThatEvalTakes) {
  const std::vector<std::string> words = {
      "fit-splats", File("seen"), "-o", File("own.ply"), "--count", "200", "--iterations", "60"};
  const ProgramResult made = RunProgram(words);
  ASSERT_EQ(made.status, 0) << made.errors;
  EXPECT_THAT(made.output, HasSubstr("front"));
  EXPECT_GT(ReadSplats(File("own.ply")).count(), 100);
  EXPECT_EQ(Eval({"--images", File("seen"), "--splats", File("own.ply")}).status, 0);

  const ProgramResult again = RunProgram(words);
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.errors, HasSubstr("own.ply"));
  std::vector<std::string> later = words;
  later.insert(later.end(), {"--force", "--frame", "6"});
  EXPECT_THAT(RunProgram(later).errors, HasSubstr("has no frame 6; its last is 5"));
}

}  // namespace
}  // namespace physpring
