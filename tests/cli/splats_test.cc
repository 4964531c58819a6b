// SPDX-License-Identifier: Apache-2.0
// `physpring splats` as a user sees it.
#include <gtest/gtest.h>

#include <filesystem>

#include "splats/splat_file.h"
#include "tests/splats/random_splats.h"
#include "tests/support/program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/predict.h"

namespace physpring {
namespace {

class SplatsCommand : public testing::Test {
 protected:
  SplatsCommand() : twin_(SmallTwin(2)), recording_(RecordingOfMotion(twin_, 6)) {
    WriteTwin(twin_, File("block.twin.npz"));
    WriteRecording(recording_, File("swing.npz"));
    const Points nodes = Predict(twin_, 0, recording_, {})[0];
    splats_ = RandomSplats(static_cast<int>(nodes.cols()), 1, 1);
    splats_.position = nodes.cast<float>();  // each in a node
    splats_.log_scale.setConstant(-6);
    WriteSplats(splats_, File("block.ply"));
  }

  std::string File(const std::string& name) const { return folder_.File(name); }

  ProgramResult Run(const std::vector<std::string>& more, const std::string& splats = "block.ply") {
    std::vector<std::string> words = {"splats", File("block.twin.npz"), File(splats)};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  }

  TemporaryFolder folder_;
  Twin twin_;
  Recording recording_;
  Splats splats_;
};

TEST_F(SplatsCommand, SplatsFollowTheNodesThatTheyAreIn) {
  const ProgramResult result = Run({"--recording", File("swing.npz"), "-o", File("moved")});
  ASSERT_EQ(result.status, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  const std::vector<Points> nodes = Predict(twin_, 0, recording_, {});
  for (std::size_t frame = 0; frame < nodes.size(); ++frame) {
    const Splats moved = ReadSplats(File("moved/frame_0000" + std::to_string(frame) + ".ply"));
    EXPECT_LT((moved.position.cast<double>() - nodes[frame]).cwiseAbs().maxCoeff(), 1e-5) << frame;
    EXPECT_EQ(moved.logit, splats_.logit);
  }
  EXPECT_FALSE(std::filesystem::exists(File("moved/frame_00006.ply")));
}

TEST_F(SplatsCommand, AnotherPlaceAndScaleAreBroughtThere) {
  Splats elsewhere = splats_;
  elsewhere.position = 100 * (elsewhere.position.colwise() - Eigen::Vector3f(1, 2, 3));
  elsewhere.log_scale.array() += std::log(100.0F);
  WriteSplats(elsewhere, File("cm.ply"));
  const ProgramResult wrong = Run({}, "cm.ply");
  EXPECT_EQ(wrong.status, 0);
  EXPECT_NE(wrong.errors.find("the splats are 100 times as large as the twin"), std::string::npos)
      << wrong.errors;
  EXPECT_NE(wrong.errors.find("another place"), std::string::npos);
  const ProgramResult right = Run({"--scale", "0.01", "--position", "1,2,3", "--recording",
                                   File("swing.npz"), "-o", File("moved"), "--every", "3"},
                                  "cm.ply");
  ASSERT_EQ(right.status, 0) << right.errors;
  EXPECT_EQ(right.errors, "");
  const Splats moved = ReadSplats(File("moved/frame_00000.ply"));
  EXPECT_LT((moved.position - splats_.position).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((moved.log_scale.array() + 6).abs().maxCoeff(), 1e-3);
  EXPECT_TRUE(std::filesystem::exists(File("moved/frame_00003.ply")));
  EXPECT_FALSE(std::filesystem::exists(File("moved/frame_00001.ply")));
}

TEST_F(SplatsCommand, FilesThatAreThereStay) {
  const std::vector<std::string> words = {"--recording", File("swing.npz"), "-o", File("moved")};
  ASSERT_EQ(Run(words).status, 0);
  const ProgramResult again = Run(words);
  EXPECT_EQ(again.status, 1);
  EXPECT_NE(again.errors.find("frame_00000.ply"), std::string::npos) << again.errors;
  // frames 0 and 5 of 6
  const ProgramResult fewer =
      Run({"--recording", File("swing.npz"), "-o", File("moved"), "--every", "5", "--force"});
  ASSERT_EQ(fewer.status, 0) << fewer.errors;
  EXPECT_NE(fewer.errors.find("has 4 files frame_*.ply of an earlier run"), std::string::npos)
      << fewer.errors;
}

TEST_F(SplatsCommand, OtherFilesAreOneLine) {
  WriteFileAtomically(File("text.ply"), "ply\nformat ascii 1.0\nend_header\n");
  const ProgramResult result = Run({}, "text.ply");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.errors,
            "physpring: " + File("text.ply") + ": is 'ascii', expected binary_little_endian\n");
}

}  // namespace
}  // namespace physpring
