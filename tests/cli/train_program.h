// SPDX-License-Identifier: Apache-2.0
// `physpring train` on two recordings of a tiny rope.
#ifndef PHYSPRING_TESTS_CLI_TRAIN_PROGRAM_H_
#define PHYSPRING_TESTS_CLI_TRAIN_PROGRAM_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/swung_rope.h"
#include "tests/support/temporary_folder.h"
#include "trainer/bodies/phystwin_variables.h"
#include "twin/atomic_file.h"

namespace physpring {

using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class Train : public testing::Test {
 protected:
  Train() {
    WriteRecording(MovingRope(8, 12), rope_);
    WriteRecording(MovingRope(8, 10), other_);
  }

  // A rope that moves as springs do.
  static Recording MovingRope(int particles, int frames) {
    Recording recording = SwungRope(particles, frames);
    PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 2);
    variables.spring_y = 1e4;
    MoveAs(MakePhysTwinSystem(recording, variables, false), true, &recording);
    return recording;
  }

  // Arguments of a short training that takes a second or less.
  Words Short(const std::string& method) const {
    Words arguments = {"train", rope_, other_, "-o", twin_, "--method", method, "--seed", "7"};
    return arguments + (method == "full"     ? Words{"--epochs", "3", "--neighbours", "4,6"}
                        : method == "smooth" ? Words{"--neighbours", "4,6"}
                                             : Words{"--epochs", "30"});
  }

  // Short, with another second recording, over what is there.
  ProgramResult TrainWithOther(const Recording& recording) const {
    WriteRecording(recording, other_);
    ProgramResult result = RunProgram(Short("two-stage") + Words{"--force"});
    EXPECT_EQ(result.status, 0) << result.errors;
    return result;
  }

  // The twin file of Short, trained without a break.
  std::string Uninterrupted(const std::string& method) const {
    const ProgramResult result = RunProgram(Short(method) + Words{"--threads", "1"});
    EXPECT_EQ(result.status, 0) << result.errors;
    const std::string bytes = ReadFile(twin_);
    std::filesystem::remove(twin_);
    return bytes;
  }

  TemporaryFolder folder_;
  std::string rope_ = folder_.File("rope.npz"), other_ = folder_.File("other.npz");
  std::string twin_ = folder_.File("rope.twin.npz"), output_ = folder_.File("output");
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_CLI_TRAIN_PROGRAM_H_
