// SPDX-License-Identifier: Apache-2.0
// Two runs with one output: the second one is refused, and the first one is not disturbed.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/cli/train_program.h"
#include "tests/support/running_program.h"
#include "tests/support/small_task.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

class TwoWriters : public Train {
 protected:
  // While the first run works, the second is refused; when it was killed, `last` is not.
  void ExpectOneAtATime(const Words& first, const Words& second, const std::string& output,
                        const Words& last) const {
    const std::string lock = output + (fs::path(output).has_extension() ? ".lock" : "/.lock");
    RunningProgram running(first, output_);
    for (int i = 0; i < 1000 && !fs::exists(lock); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_TRUE(fs::exists(lock)) << ReadFile(output_);
    const ProgramResult refused = RunProgram(second);
    EXPECT_TRUE(FailsWith(refused, output + ": another physpring is writing it"))
        << refused.status << refused.errors;
    running.Signal(SIGKILL);
    running.Wait();
    const ProgramResult free = RunProgram(last);
    EXPECT_EQ(free.status, 0) << free.errors;
    EXPECT_FALSE(fs::exists(lock));
  }

  std::string folder_output_ = folder_.File("out");
};

TEST_F(TwoWriters, OfATwinAreRefused) {
  const Words forever = {"train",    rope_,       "-o",       twin_,
                         "--method", "two-stage", "--epochs", "1000000"};
  ExpectOneAtATime(forever, Short("two-stage") + Words{"--force"}, twin_,
                   Short("two-stage") + Words{"--force"});
}

TEST_F(TwoWriters, OfASweepAreRefused) {
  const SmallTask task;
  const auto sweep = [&](const std::string& episodes, const std::string& first) {
    return Words{"rollout", task.path(), "--policy", "random", "--episodes",
                 episodes,  "--first",   first,      "-o",     folder_output_};
  };
  ExpectOneAtATime(sweep("100000", "0"), sweep("2", "200000"), folder_output_, sweep("2", "0"));
}

TEST_F(TwoWriters, OfADiagnosisAreRefused) {
  Twin heavy = SmallTwin(1);
  heavy.levels[0].system.mass.head(8) *= 3;
  const std::string twin = folder_.File("small.twin.npz"), swing = folder_.File("swing.npz");
  WriteRecording(RecordingOfMotion(heavy, 60), swing);
  WriteTwin(SmallTwin(1), twin);
  const Words diagnose = {"diagnose", twin, swing, "-o", folder_output_, "--force"};
  WriteRecording(RecordingOfMotion(heavy, 14), folder_.File("short.npz"));
  ExpectOneAtATime(diagnose, diagnose, folder_output_,
                   {"diagnose", twin, folder_.File("short.npz"), "-o", folder_output_, "--force"});
}

}  // namespace
}  // namespace physpring
