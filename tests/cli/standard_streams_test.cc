// SPDX-License-Identifier: Apache-2.0
// Standard output and errors that are full or closed.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "tests/cli/train_program.h"
#include "tests/support/running_program.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

class StandardStreams : public Train {
 protected:
  StandardStreams() { WriteTwin(SmallTwin(1), small_); }

  // Runs the program with `redirections` of the shell.
  ProgramResult RunWith(const Words& words, const std::string& redirections) const {
    std::string command = PHYSPRING_PROGRAM;
    for (const std::string& word : words) command += " '" + word + "'";
    const int status =
        std::system(("( " + command + " ) 2>'" + output_ + "' " + redirections).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", ReadFile(output_)};
  }

  std::string small_ = folder_.File("small.twin.npz");
};

TEST_F(StandardStreams, AReportThatDoesNotArriveIsAFailure) {
  WriteRecording(RecordingOfMotion(SmallTwin(1), 6), folder_.File("swing.npz"));
  for (const Words& words :
       {Words{"info", small_}, Words{"eval", small_, folder_.File("swing.npz")},
        Words{"train", "--help"}, Words{"--version"}, Words{"doctor"}}) {
    EXPECT_TRUE(FailsWith(RunWith(words, ">/dev/full"), "standard output: cannot be written: "))
        << words[0];
  }
  EXPECT_TRUE(FailsWith(RunWith({"info", small_}, ">/dev/full"), "No space left on device"));
}

TEST_F(StandardStreams, FilesAreWrittenAllTheSame) {
  ASSERT_EQ(RunWith(Short("two-stage"), ">/dev/full").status, 1);
  EXPECT_NO_THROW(ReadTwin(twin_));
}

TEST_F(StandardStreams, ThatAreFullStopNoTraining) {
  const std::string whole = Uninterrupted("two-stage");
  RunningProgram program(Short("two-stage"), "/dev/full");
  EXPECT_EQ(program.Wait(), 1);  // the report is lost
  EXPECT_TRUE(ReadFile(twin_) == whole);
}

// Else the twin would be the first file that is opened, and the report be printed into it.
TEST_F(StandardStreams, ThatAreClosedGetIntoNoFile) {
  const std::string whole = Uninterrupted("two-stage");
  EXPECT_EQ(RunWith(Short("two-stage"), ">&- 2>&- <&-").status, 0);
  EXPECT_TRUE(ReadFile(twin_) == whole);
}

TEST_F(StandardStreams, ALogThatIsFullIsAFailureAfterTheTraining) {
  const std::string whole = Uninterrupted("two-stage");
  const ProgramResult result = RunProgram(Short("two-stage") + Words{"--log", "/dev/full"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.errors.find("physpring: /dev/full: has not all lines, though " + twin_),
            std::string::npos)
      << result.errors;
  EXPECT_TRUE(ReadFile(twin_) == whole);
}

TEST_F(StandardStreams, JsonThatDoesNotArriveIsAFailure) {
  const ProgramResult result = RunProgram({"info", small_, "--json", "/dev/full"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.errors, "physpring: /dev/full: cannot be written: No space left on device\n");
}

}  // namespace
}  // namespace physpring
