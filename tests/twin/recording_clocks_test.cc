// SPDX-License-Identifier: Apache-2.0
// Recordings whose frames have times of their own, and forces.
#include <gtest/gtest.h>

#include <vector>

#include "tests/support/recording_file.h"
#include "twin/clock_offset.h"
#include "twin/error.h"

namespace physpring {
namespace {

class TimedRecording : public RecordingFile {
 protected:
  void SetTimes(const std::string& name, const std::vector<double>& times) {
    arrays_[name] = NpzArray::Doubles({times.size()}, times.data());
  }
};

TEST_F(TimedRecording, PutsMissingFramesIn) {
  arrays_.erase("fps");
  SetTimes("timestamps", {1.7e9, 1.7e9 + 0.02, 1.7e9 + 0.04, 1.7e9 + 0.08});
  const Recording read = ReadChanged();
  const Recording all = MakeRecording();
  ASSERT_EQ(read.frame_count(), 5);
  EXPECT_NEAR(read.fps, 50, 1e-4);
  EXPECT_EQ(read.points[2], all.points[2]);
  EXPECT_TRUE(read.points[3].array().isNaN().all());
  EXPECT_EQ(read.points[4], all.points[3]);
  EXPECT_TRUE(read.surface[3].array().isNaN().all());
  // they move evenly
  EXPECT_TRUE(read.controllers[3].isApprox((all.controllers[2] + all.controllers[3]) / 2, 0.02));
  EXPECT_EQ(read.train_frames, 3);
  EXPECT_FALSE(read.two_clocks);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_EQ(read.notes[0], path_ +
                               ": 1 of 5 frames at 50 a second are missing: points are not seen "
                               "there");
}

// Nobody knows when in a gap a hand closes, so it does at its end; and it opens at its beginning.
TEST_F(TimedRecording, HandsAreOpenWhereFramesAreMissing) {
  arrays_.erase("fps");
  for (const char* of_start : {"rest", "order"}) arrays_.erase(of_start);
  SetTimes("timestamps", {0, 0.02, 0.08, 0.1});
  const std::vector<int> closes = {0, 0, 1, 1}, opens = {1, 1, 0, 0};
  arrays_["held"] = NpzArray::Ints({4, 1}, closes.data());
  Recording read = ReadChanged();
  ASSERT_EQ(read.frame_count(), 6);
  EXPECT_FALSE(read.held.col(0).head(4).any());
  EXPECT_TRUE(read.held.col(0).tail(2).all());
  arrays_["held"] = NpzArray::Ints({4, 1}, opens.data());
  read = ReadChanged();
  EXPECT_TRUE(read.held.col(0).head(2).all());
  EXPECT_FALSE(read.held.col(0).tail(4).any());
}

TEST_F(TimedRecording, SaysThatUnevenFramesAreInterpolated) {
  arrays_.erase("fps");
  SetTimes("timestamps", {0, 0.02, 0.043, 0.06});
  const Recording read = ReadChanged();
  EXPECT_EQ(read.frame_count(), 4);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("1.5 ms off a fixed rate"), std::string::npos) << read.notes[0];
}

TEST_F(TimedRecording, ControllersMayHaveAClockOfTheirOwn) {
  std::vector<double> hands, times;
  for (int t = 0; t < 9; ++t) {
    times.push_back(0.01 * t);
    for (double x : {0.1 * t, 0.0, 1.25}) hands.push_back(x);
  }
  const double fps = 50;
  arrays_["fps"] = NpzArray::Doubles({}, &fps);
  arrays_["controllers"] = NpzArray::Doubles({9, 1, 3}, hands.data());
  SetTimes("controller_timestamps", times);
  const Recording read = ReadChanged();
  EXPECT_TRUE(read.two_clocks);
  ASSERT_EQ(read.controllers.size(), 4U);
  for (int t = 0; t < 4; ++t) EXPECT_NEAR(read.controllers[t](0, 0), 0.2 * t, 1e-12);
  EXPECT_TRUE(read.warnings.empty());
}

TEST_F(TimedRecording, SaysWhereControllersAreNotMeasured) {
  const double fps = 50;
  arrays_["fps"] = NpzArray::Doubles({}, &fps);
  SetTimes("controller_timestamps", {0.05, 0.07, 0.09, 0.11});
  const Recording read = ReadChanged();
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_EQ(read.warnings[0], path_ +
                                  ": the controllers were not measured in 3 of 4 frames at the "
                                  "start or end, and stand still there");
  EXPECT_EQ(read.controllers[0], MakeRecording().controllers[0]);
}

TEST_F(TimedRecording, RefusesTimesThatSayNothing) {
  struct Case {
    const char* name;
    std::vector<double> times;
    const char* message;
  };
  const std::vector<Case> cases{
      {"timestamps", {0, 0.1, 0.1, 0.2}, "'timestamps' holds 0.1 s at [2] after 0.1 s, expected"},
      {"timestamps", {0, 0.1, 0.2}, "'timestamps' has the shape (3,), expected (T,) with T = 4"},
      {"timestamps", {0, 20, 40, 60}, "'timestamps' makes 0.05 frames a second, expected 0.1 to"},
      {"timestamps", {0, 0.01, 0.02, 9}, "'timestamps' spans 901 frames at 100 a second, of which"},
      {"timestamps", {0, kNan, 0.02, 9}, "'timestamps' holds nan"},
      {"controller_timestamps", {100, 101, 102, 103}, "no controller is known in any frame"},
  };
  const Npz sound = arrays_;
  for (const Case& c : cases) {
    arrays_ = sound;
    if (c.name == std::string("timestamps")) arrays_.erase("fps");
    SetTimes(c.name, c.times);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find(c.message), std::string::npos) << error;
  }
}

TEST_F(TimedRecording, ReadsBackForcesAndClocks) {
  Recording recording = MakeRecording();
  recording.two_clocks = true;
  for (int t = 0; t < 4; ++t) recording.force.emplace_back(Points::Constant(3, 1, t));
  recording.force[2].setConstant(kNan);
  WriteRecording(recording, path_);
  const Recording read = ReadRecording(path_);
  EXPECT_TRUE(read.two_clocks);
  EXPECT_EQ(read.controllers, recording.controllers);
  ASSERT_EQ(read.force.size(), 4U);
  EXPECT_EQ(read.force[3], recording.force[3]);
  EXPECT_TRUE(read.force[2].array().isNaN().all());
}

TEST_F(TimedRecording, ForcesMayBeSizes) {
  const std::vector<double> sizes{1, 2, kNan, 4};
  arrays_["force"] = NpzArray::Doubles({4, 1}, sizes.data());
  const Recording read = ReadChanged();
  ASSERT_EQ(read.force[1].rows(), 1);
  EXPECT_EQ(read.force[1](0, 0), 2);
  const double infinite = std::numeric_limits<double>::infinity();
  arrays_["force"] = NpzArray::Doubles({4, 1}, std::vector<double>{1, 2, infinite, 4}.data());
  EXPECT_NE(ErrorOfChanged().find("'force' holds an infinite number in frame 2"),
            std::string::npos);
  arrays_["force"] = NpzArray::Doubles({4, 1}, std::vector<double>{1, 2, 3, -4}.data());
  EXPECT_NE(ErrorOfChanged().find("'force' holds the size -4 N at frame 3, controller 0"),
            std::string::npos);
  arrays_["force"] = NpzArray::Doubles({4, 2}, std::vector<double>(8).data());
  EXPECT_NE(ErrorOfChanged().find("expected (T, C) with T = 4, C = 1"), std::string::npos);
}

TEST(ClockOffset, ShiftsControllersOfRecordingsWithTwoClocksAlone) {
  Recording recording = MakeRecording();
  recording.fps = 50;
  recording.start = Points::Zero(3, 5);
  recording.rest_given = false;
  recording.rest = recording.start;
  Twin twin;
  twin.clock_offset = 0.03;  // a frame and a half
  const std::vector<Points> as_recorded = recording.controllers;
  UseClockOf(twin, &recording);
  EXPECT_EQ(recording.controllers, as_recorded);
  recording.two_clocks = true;
  UseClockOf(twin, &recording);
  EXPECT_EQ(recording.controllers[0], as_recorded[0]);
  EXPECT_TRUE(recording.controllers[2].isApprox((as_recorded[0] + as_recorded[1]) / 2, 1e-9));
  EXPECT_TRUE(recording.controllers[3].isApprox((as_recorded[1] + as_recorded[2]) / 2, 1e-9));
  EXPECT_EQ(recording.start.rightCols(1), recording.controllers[0]);
}

}  // namespace
}  // namespace physpring
