// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "report/info_text.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

TEST(RecordingInfo, TellsOfGraspsClocksObjectsAndForces) {
  Recording recording = RecordingOfMotion(SmallTwin(1), 10);
  EXPECT_TRUE(RecordingToJson(recording)["held_frames"].is_null());
  EXPECT_TRUE(RecordingToJson(recording)["force"].is_null());
  EXPECT_EQ(RecordingToJson(recording)["objects"], 1);
  recording.held.setConstant(10, 2, true);
  recording.held.col(1).tail(4).setConstant(false);
  recording.force.assign(10, Eigen::MatrixXd::Ones(1, 2));
  recording.force[4](0, 1) = std::numeric_limits<double>::quiet_NaN();
  recording.two_clocks = true;
  recording.object = Eigen::VectorXi::LinSpaced(42, 0, 1);
  const Json json = RecordingToJson(recording);
  EXPECT_EQ(json["held_frames"], (Json{{0, 9}, {0, 5}}));
  EXPECT_EQ(json["force"], (Json{{"components", 1}, {"measured_fraction", 0.95}}));
  EXPECT_EQ(json["two_clocks"], true);
  EXPECT_EQ(json["objects"], 2);
  const std::string text = DescribeRecording(recording);
  for (const char* line : {"controllers  2, one for each time that one holds: 1 in frames 0 to 5, "
                           "1 in frames 0 to 9\n",
                           "clocks       the controllers have one of their own\n",
                           "objects      2\n", "force        sizes, 95.0 % of them measured\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace physpring
