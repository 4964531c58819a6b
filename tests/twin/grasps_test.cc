// SPDX-License-Identifier: Apache-2.0
// Grasps that begin and end: how they are read.
#include "twin/grasps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/recording_file.h"
#include "tests/support/swung_rope.h"
#include "twin/column_names.h"
#include "twin/error.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

class HeldRecording : public RecordingFile {
 protected:
  void SetHeld(const std::vector<int>& held) {
    arrays_["held"] = NpzArray::Ints({held.size(), 1}, held.data());
  }
};

TEST_F(HeldRecording, AGraspThatLastsIsTheController) {
  SetHeld({1, 1, 1, 1});
  const Recording read = ReadChanged(), all = MakeRecording();
  EXPECT_EQ(read.controllers, all.controllers);
  EXPECT_TRUE(read.held.all());
  EXPECT_TRUE(LateGraspsOf(read).empty());
}

TEST_F(HeldRecording, AGraspThatEndsIsReleased) {
  SetHeld({1, 1, 0, 0});
  SetValue("controllers", 9, kNan);
  SetValue("controllers", 10, kNan);
  SetValue("controllers", 11, kNan);
  const Recording read = ReadChanged(), all = MakeRecording();
  EXPECT_TRUE(RecordedInput(read, 1, 0).released.empty());
  EXPECT_EQ(RecordedInput(read, 2, 0).released, ControllerMask{true});
  EXPECT_EQ(RecordedInput(read, 3, 0).released, ControllerMask{true});
  EXPECT_TRUE(LateGraspsOf(read).empty());
  EXPECT_EQ(read.controllers[1], all.controllers[1]);
  EXPECT_EQ(read.controllers[3], all.controllers[1]);  // it stands still
  EXPECT_EQ(read.start.rightCols(1), all.controllers[0]);
  WriteRecording(read, path_);
  EXPECT_TRUE((ReadRecording(path_).held == read.held).all());
}

// The points move by 0.125 m a frame along all axes.
TEST_F(HeldRecording, AGraspThatBeginsLateIsCarriedBack) {
  for (const char* of_start : {"rest", "order"}) arrays_.erase(of_start);
  SetHeld({0, 0, 1, 1});
  const Recording read = ReadChanged(), all = MakeRecording();
  const Eigen::Vector3d place = all.controllers[2].col(0) - Eigen::Vector3d::Constant(0.25);
  EXPECT_TRUE(read.start.col(4).isApprox(place, 1e-9));
  EXPECT_TRUE(read.rest.col(4).isApprox(place, 1e-9));
  EXPECT_EQ(RecordedInput(read, 2, 0).released, ControllerMask{true});
  EXPECT_TRUE(RecordedInput(read, 3, 0).released.empty());
}

TEST_F(HeldRecording, EachGraspIsAControllerOfItsOwn) {
  constexpr int kLast = 23;
  Recording rope = SwungRope(8, kLast + 1);
  for (int t = 0; t <= kLast; ++t) {  // the rope goes along with its hand
    rope.points[t].colwise() += (rope.controllers[t] - rope.controllers[0]).col(0);
  }
  rope.held.resize(kLast + 1, 1);
  rope.held.setConstant(true);
  rope.held.block(8, 0, 4, 1).setConstant(false);
  for (int t = 12; t <= kLast; ++t) rope.controllers[t].row(2).array() -= 0.05;  // further down
  for (int t = 0; t <= kLast; ++t) rope.force.emplace_back(Points::Constant(3, 1, t));
  WriteRecording(rope, path_);
  const Recording read = ReadRecording(path_);
  ASSERT_EQ(read.controller_count(), 2);
  EXPECT_TRUE(read.held.col(0).head(8).all() && !read.held.col(0).tail(16).any());
  EXPECT_TRUE(read.held.col(1).tail(12).all() && !read.held.col(1).head(12).any());
  EXPECT_TRUE(read.start.col(8).isApprox(rope.start.col(8), 1e-6));
  const Eigen::Vector3d lower = rope.start.col(8) - Eigen::Vector3d(0, 0, 0.05);
  EXPECT_LT((read.start.col(9) - lower).norm(), 1e-6);
  EXPECT_LT((read.rest.col(9) - lower).norm(), 1e-6);
  EXPECT_EQ(read.force[3](0, 0), 3);
  EXPECT_TRUE(std::isnan(read.force[3](0, 1)));
  EXPECT_EQ(read.force[20](0, 1), 20);
  EXPECT_EQ(RecordedInput(read, 7, 0).released, (ControllerMask{false, true}));
  EXPECT_EQ(RecordedInput(read, 8, 0).released, (ControllerMask{true, true}));
  EXPECT_EQ(RecordedInput(read, 13, 0).released, (ControllerMask{true, false}));
  EXPECT_TRUE(RecordedInput(read, 12, 0).attached.attached.empty());
  EXPECT_EQ(RecordedInput(read, 13, 0).attached.attached, (ControllerMask{false, true}));
  EXPECT_TRUE(RecordedInput(read, 14, 0).attached.attached.empty());
  EXPECT_EQ(RecordedInput(read, 13, 0).attached.nodes, read.points[12]);
  EXPECT_EQ(LateGraspsOf(read), (ControllerMask{false, true}));
}

class LateGrasp : public HeldRecording {
 protected:
  static constexpr int kParticles = 20, kFrames = 24, kTakesHold = 12;

  LateGrasp() {
    rope_ = SwungRope(kParticles, kFrames);
    for (int t = 0; t < kFrames; ++t) {  // it goes along with its hand
      rope_.points[t].colwise() += (rope_.controllers[t] - rope_.controllers[0]).col(0);
    }
    rope_.held.setConstant(kFrames, 1, true);
    rope_.held.topRows(kTakesHold).setConstant(false);
  }

  Recording Read(const Recording& rope) {
    WriteRecording(rope, path_);
    return ReadRecording(path_);
  }

  // That the hand takes hold of, from the hand, m.
  static Eigen::Vector3d Place(const Recording& read) { return read.start.col(kParticles); }

  Recording rope_;
};

TEST_F(LateGrasp, IsNotMisledByAMeasurementThatJumps) {
  const Recording right = Read(rope_);
  rope_.points[kTakesHold](1, 0) += 0.5;
  const Recording read = Read(rope_);
  EXPECT_LT((Place(read) - Place(right)).norm(), 1e-3);
  const auto nodes = [](const Recording& one) { return one.shape_when_held.at(kTakesHold); };
  EXPECT_LT((nodes(read) - nodes(right)).cwiseAbs().maxCoeff(), 2e-3);
}

TEST_F(LateGrasp, TakesFromTheFramesBesideItWhatIsNotSeen) {
  const Recording right = Read(rope_);
  for (int t : {kTakesHold - 1, kTakesHold}) rope_.points[t].setConstant(kNan);
  const Recording read = Read(rope_);
  EXPECT_LT((Place(read) - Place(right)).norm(), 5e-3);
  for (const std::string& warning : read.warnings) {
    EXPECT_EQ(warning.find("is a guess"), std::string::npos) << warning;
  }
}

TEST_F(LateGrasp, IsNamedByItsFrame) {
  const Recording read = Read(rope_);
  EXPECT_EQ(NameOfController(read, 0), "controller 0, the grasp from frame 12 on,");
  rope_.held.setConstant(true);
  EXPECT_EQ(NameOfController(Read(rope_), 0), "controller 0");
}

TEST_F(LateGrasp, SaysThatItIsAGuessWhereFewPointsAreSeen) {
  for (int t = kTakesHold - 7; t < kTakesHold + 8; ++t) {
    rope_.points[t].leftCols(kParticles - 3).setConstant(kNan);
  }
  const Recording read = Read(rope_);
  EXPECT_THAT(read.warnings,
              testing::Contains(testing::HasSubstr(
                  "few of the points around controller 0 are seen when it takes hold "
                  "in frame 12, so what it holds is a guess")));
}

TEST_F(HeldRecording, RefusesWhatIsNoGrasp) {
  SetHeld({1, 0, 1, 0});
  EXPECT_EQ(ErrorOfChanged(),
            path_ + ": array 'held' says that controller 0 holds in no two frames in a row");
  SetHeld({1, 1, 2, 1});
  EXPECT_EQ(ErrorOfChanged(), path_ + ": array 'held' holds 2 at [2, 0], expected 0 or 1");
  SetHeld({1, 1, 1, 0});
  for (std::size_t k = 3; k < 6; ++k) SetValue("controllers", k, kNan);
  EXPECT_EQ(ErrorOfChanged(),
            path_ + ": array 'controllers' holds nan at [1, 0], where 'held' says that it holds");
}

}  // namespace
}  // namespace physpring
