// SPDX-License-Identifier: Apache-2.0
// `physpring train` refuses in one line, and what it never overwrites.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "tests/cli/train_program.h"
#include "tests/support/program.h"
#include "tests/support/swung_rope.h"
#include "twin/twin.h"

namespace physpring {
namespace {

TEST_F(Train, OverwritesAFinishedTwinOnlyByForce) {
  const Words words = Short("two-stage");
  ASSERT_EQ(RunProgram(words).status, 0);
  const std::string bytes = ReadFile(twin_);
  EXPECT_TRUE(FailsWith(RunProgram(words), twin_ + ": is a finished twin; --force"));
  EXPECT_TRUE(ReadFile(twin_) == bytes);
  EXPECT_EQ(RunProgram(words + Words{"--force"}).status, 0);
  EXPECT_TRUE(ReadFile(twin_) == bytes);
  const ProgramResult resumed = RunProgram(words + Words{"--resume"});
  EXPECT_EQ(resumed.status, 0) << resumed.errors;
  EXPECT_TRUE(ReadFile(twin_) == bytes);
}

TEST_F(Train, NeedsPointsThatAreSeenAfterTheFirstFrame) {
  Recording recording = MovingRope(8, 12);
  for (std::size_t t = 1; t < recording.points.size(); ++t) {
    recording.points[t].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  WriteRecording(recording, other_);
  EXPECT_TRUE(FailsWith(RunProgram({"train", other_, "-o", twin_}),
                        other_ + ": no point is seen in frames 1 to "));
  EXPECT_FALSE(std::filesystem::exists(twin_));
}

TEST_F(Train, NeverOverwritesWhatIsNoTwin) {
  const std::string bytes = ReadFile(other_);
  for (const char* flag : {"--force", "--resume"}) {
    EXPECT_TRUE(FailsWith(RunProgram({"train", rope_, "-o", other_, flag}),
                          other_ + ": is there and no twin"))
        << flag;
  }
  EXPECT_TRUE(ReadFile(other_) == bytes);
}

TEST_F(Train, ResumesOnlyWhatWasTrainedTheSameWay) {
  const Words words = Short("two-stage") + Words{"--resume"};
  ASSERT_EQ(RunProgram(words).status, 0);
  const auto fails = [&](const Words& more, const std::string& part) {
    Words changed = words;
    for (std::size_t i = 0; i + 1 < more.size(); i += 2) {
      const auto flag = std::find(changed.begin(), changed.end(), more[i]);
      if (flag == changed.end()) {
        changed = changed + Words{more[i], more[i + 1]};
      } else {
        flag[1] = more[i + 1];
      }
    }
    const ProgramResult result = RunProgram(changed);
    EXPECT_TRUE(FailsWith(result, part)) << result.errors;
  };
  fails({"--epochs", "31"}, twin_ + ": was trained with epochs 30, not 31");
  fails({"--seed", "8"}, ": was trained with seed 7, not 8");
  fails({"--precision", "float"}, ": was trained with precision \"double\", not \"float\"");
  fails({"--method", "full"}, ": was trained with method \"two-stage\", not \"full\"");
  Twin twin = ReadTwin(twin_);
  ASSERT_EQ(twin.training_state.erase("train/code"), 1U);
  WriteTwin(twin, twin_);
  fails({}, twin_ + ": its training was begun by another version of physpring");
  WriteRecording(MovingRope(8, 11), other_);
  fails({}, ": recording 2 was other with hash ");
}

TEST_F(Train, RefusesRecordingsOfDifferentObjects) {
  WriteRecording(SwungRope(9, 5), other_);
  EXPECT_TRUE(FailsWith(RunProgram({"train", rope_, other_, "-o", twin_}),
                        other_ + ": has 9 points, but " + rope_ + " has 8; expected recordings"));
  Recording slower = SwungRope(8, 5);
  slower.fps = 25;
  WriteRecording(slower, other_);
  EXPECT_TRUE(FailsWith(RunProgram({"train", rope_, other_, "-o", twin_}),
                        other_ + ": has 25 frames a second, but " + rope_ + " has 50"));
  EXPECT_FALSE(std::filesystem::exists(twin_));
}

TEST_F(Train, FailsInOneLineAndWritesNothing) {
  const auto fails = [&](const Words& words, const std::string& part) {
    const ProgramResult result = RunProgram(words);
    EXPECT_TRUE(FailsWith(result, part)) << result.errors;
    EXPECT_FALSE(std::filesystem::exists(twin_)) << part;
  };
  fails({"train", folder_.File("none.npz"), "-o", twin_}, "none.npz: does not exist");
  fails({"train", rope_, rope_, "-o", twin_}, "rope.npz: is given twice");
  const std::string copy = folder_.File("copy.npz");
  std::filesystem::copy_file(rope_, copy);
  fails({"train", rope_, copy, "-o", twin_}, "copy.npz: is the same recording as " + rope_);
  fails({"train", rope_, "-o", folder_.File("none/rope.twin.npz")},
        "none/rope.twin.npz: cannot be written: its folder is missing");
  fails({"train", rope_, "-o", twin_, "--log", folder_.path()},
        folder_.path() + ": cannot be written");
  fails({"train", rope_, "-o", twin_, "--method", "two-stage", "--substeps", "1"},
        "the motion diverges with every start value tried; 1 sub-steps a frame are too few");
  Recording two = SwungRope(8, 5);
  two.start.leftCols(4).row(0).array() += 1;
  two.points[0] = two.start.leftCols(8);
  WriteRecording(two, rope_);
  fails({"train", rope_, "-o", twin_, "--method", "two-stage"},
        "the particles fall into separate objects");
}

TEST_F(Train, RefusesBadUsage) {
  const auto refused = [&](const Words& more, const std::string& part) {
    const ProgramResult result = RunProgram(Words{"train", rope_, "-o", twin_} + more);
    EXPECT_EQ(result.status, 2) << part;
    EXPECT_NE(result.errors.find(part), std::string::npos) << result.errors;
  };
  refused({"--levels", "0"}, "--levels: takes a whole number from 1 to 10, not '0'");
  refused({"--levels", "5"}, "--ratios: needs one ratio for each level but level 0");
  refused({"--levels", "2", "--ratios", "1.5"}, "--ratios: takes a number from 0 to 1");
  refused({"--reduction", "best"}, "--reduction: takes learned or random or gramian or kmeans");
  refused({"--levels", "2", "--reduction", "kmeans", "--features", "positions"},
          "--features: is of --reduction learned");
  refused({"--method", "three-stage"},
          "--method: takes full or smooth or two-stage, not 'three-stage'");
  for (const char* epochs : {"-1", "0", "2.5", "ten", "3x", ""}) {
    refused({std::string("--epochs=") + epochs}, "--epochs");
  }
  refused({"--epochs", "-1"},
          "--epochs: takes a whole number from 1 to 1000000, or auto, not '-1'");
  refused({"--neighbours", "8,many"},
          "--neighbours: takes a whole number from 1 to 1000, or auto, not 'many'");
  refused({"--threads", "0"}, "--threads: takes a whole number from 1 to 1024, not '0'");
  refused({"--seed", "-3"},
          "--seed: takes a whole number from 0 to 18446744073709551615, not '-3'");
  refused({"--neighbours", "8", "--method", "two-stage"}, "--neighbours: is chosen by two-stage");
  refused({"--optimizer", "adam", "--method", "smooth"}, "--optimizer: is of --method full");
  refused({"--epochs", "3", "--method", "smooth"}, "--epochs: is not of --method smooth");
  refused({"--reduction", "kmeans"}, "--reduction: needs --levels 2 or more");
  refused({"--features", "positions"}, "--features: needs --levels 2 or more");
  refused({"--latent", "5"}, "--latent: needs --levels 2 or more");
  refused({"--levels", "2", "--ratios", "0.5,0.3"}, "--ratios: are of levels 1, 2, ...");
  refused({"--self-collision"}, "--self-collision: is of --method two-stage");
  refused({"--resume", "--force"}, "--resume excludes --force");
  for (const char* name : {"rope.txt", "rope", ".npz", ""}) {
    const ProgramResult result = RunProgram({"train", rope_, "-o", name});
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.errors.find("takes a file name that ends with .npz"), std::string::npos)
        << result.errors;
  }
}

}  // namespace
}  // namespace physpring
