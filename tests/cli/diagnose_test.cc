// SPDX-License-Identifier: Apache-2.0
// `physpring diagnose` as a user sees it, as far as it goes before the work.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"

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

  ProgramResult Run(const std::string& output, const std::string& json) {
    return RunProgram(
        {"diagnose", twin_, swing_, "--heldout", held_, "-o", output, "--json", json});
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

}  // namespace
}  // namespace physpring
