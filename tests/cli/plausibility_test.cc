// SPDX-License-Identifier: Apache-2.0
// Recordings that are not quite what the program assumes, as a user meets them: the right twin, or
// a line that says what is wrong. The ropes come from a simulator of their own (plain_rope.h), so
// the right values are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/plain_rope.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

using testing::HasSubstr;
using testing::Not;

class Plausibility : public testing::Test {
 protected:
  // Trains quickly; what it says on standard error.
  ProgramResult TrainOn(const Recording& recording) {
    WriteRecording(recording, recording_);
    return RunProgram({"train", recording_, "-o", twin_, "--neighbours", "2", "--force"});
  }
  // Track errors of the later frames, m.
  double LaterError(const std::string& row = "") {
    EXPECT_EQ(RunProgram({"eval", twin_, recording_, "--json", json_}).status, 0);
    const auto json = nlohmann::json::parse(ReadFile(json_));
    return (row.empty() ? json["levels"][0] : json[row])["prediction"]["track"];
  }

  TemporaryFolder folder_;
  std::string recording_ = folder_.File("rope.npz"), twin_ = folder_.File("rope.twin.npz"),
              json_ = folder_.File("rope.json");
};

TEST_F(Plausibility, SaysNothingOfARopeThatHangs) {
  const ProgramResult result = TrainOn(PlainRope().Record());
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.errors, Not(HasSubstr("warning")));
  EXPECT_THAT(result.errors, Not(HasSubstr("note")));
  EXPECT_LT(LaterError(), 0.005);
  EXPECT_GT(LaterError("rigid"), 0.05);
  EXPECT_GT(LaterError("linear"), 0.02);
}

TEST_F(Plausibility, ExplainsAStartInMotion) {
  PlainRope rope;
  rope.before = 1;
  const ProgramResult result = TrainOn(rope.Record());
  EXPECT_THAT(result.errors,
              HasSubstr("note: " + recording_ + ": starts in motion: velocities are taken"));
  EXPECT_THAT(result.errors, Not(HasSubstr("warning")));
  EXPECT_LT(LaterError(), 0.01);  // from rest 58 mm
}

TEST_F(Plausibility, LeavesOutATrackThatJumps) {
  Recording recording = PlainRope().Record();
  for (int t = 40; t < 120; ++t) recording.points[t].col(6) += Eigen::Vector3d(0.3, 0.2, 0.1);
  EXPECT_THAT(TrainOn(recording).errors, HasSubstr("point 6 jumps by 0.3"));
  EXPECT_LT(LaterError(), 0.005);  // with it 49 mm
}

TEST_F(Plausibility, KeepsTwoObjectsApart) {
  EXPECT_THAT(TrainOn(TwoRopes()).errors, HasSubstr("shows 2 objects that part"));
  EXPECT_LT(LaterError(), 0.005);  // joined 104 mm
}

TEST_F(Plausibility, SaysThatATwinIsUseless) {
  const Recording y_up = Mapped(PlainRope().Record(), [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x[0], x[2], -x[1]);
  });
  const ProgramResult result = TrainOn(y_up);
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.errors, HasSubstr("which axis points up?"));
  EXPECT_THAT(result.errors, HasSubstr("warning: the twin explains "));
  for (const char* command : {"info", "eval"}) {
    const bool info = std::string(command) == "info";
    const ProgramResult again =
        info ? RunProgram({command, recording_}) : RunProgram({command, twin_, recording_});
    EXPECT_THAT(again.errors, HasSubstr("which axis points up?")) << command;
    EXPECT_EQ(again.errors.find("warning: the twin explains ") == std::string::npos, info);
  }
}

}  // namespace
}  // namespace physpring
