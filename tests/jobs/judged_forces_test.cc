// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "jobs/training.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

class JudgedForces : public testing::Test {
 protected:
  JudgedForces() : twin_(SmallTwin(1)) {
    Recording recording = RecordingOfMotion(twin_, 6);
    recording.name = "block.npz";
    recording.mass = twin_.levels[0].system.mass.sum();
    recording.force.assign(6, Eigen::MatrixXd::Ones(1, 2));
    task_.data.recordings.push_back(recording);
    task_.data.continuous_recording.push_back(0);
  }

  // What is said of forces.
  std::string Said() const {
    std::string said;
    for (const std::string& line : JudgeTraining(task_, twin_).warnings) {
      if (line.find("'force'") != std::string::npos) said += line;
    }
    return said;
  }

  Twin twin_;
  TrainingTask task_;
};

TEST_F(JudgedForces, ThatSetTheScaleFarFromTheRecordingAreNamed) {
  twin_.force_scale = 1;
  EXPECT_EQ(Said(), "");
  twin_.levels[0].system.mass *= 95;
  const std::string said = Said();
  EXPECT_EQ(said.find("recording block.npz: array 'force' makes it "), 0U) << said;
  EXPECT_NE(said.find("95 times its 'mass' of"), std::string::npos) << said;
}

TEST_F(JudgedForces, ThatAreNotUsedAreNamedWithTheCause) {
  EXPECT_NE(Said().find("does not agree with how the grasps must pull"), std::string::npos);
  for (Eigen::MatrixXd& frame : task_.data.recordings[0].force) frame.setConstant(std::nan(""));
  EXPECT_NE(Said().find("has no number in a frame for fitting"), std::string::npos);
}

}  // namespace
}  // namespace physpring
