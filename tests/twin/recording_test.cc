// SPDX-License-Identifier: Apache-2.0
// Recordings are read as they were written.
#include "twin/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/development_data.h"
#include "tests/support/recording_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

// Equal, where NaN equals NaN.
void ExpectEqual(const std::vector<Points>& a, const std::vector<Points>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t t = 0; t < a.size(); ++t) {
    ASSERT_EQ(a[t].cols(), b[t].cols());
    EXPECT_TRUE(a[t].array().isNaN().cwiseEqual(b[t].array().isNaN()).all());
    EXPECT_TRUE((a[t].array().isNaN() || a[t].array() == b[t].array()).all());
  }
}

TEST_F(RecordingFile, ReadsBackWhatWasWritten) {
  const Recording expected = MakeRecording();
  const Recording read = ReadRecording(path_);
  EXPECT_EQ(read.name, "rope");
  EXPECT_EQ(read.hash, HashFile(path_));
  ExpectEqual(read.points, expected.points);
  ExpectEqual(read.controllers, expected.controllers);
  ExpectEqual(read.surface, expected.surface);
  ExpectEqual(read.track, expected.track);
  EXPECT_EQ(read.fps, 29.97);
  EXPECT_EQ(read.mass, 0.3);
  EXPECT_EQ(read.gravity, expected.gravity);
  EXPECT_EQ(read.ground, expected.ground);
  EXPECT_EQ(read.interior, expected.interior);
  EXPECT_EQ(read.rest, expected.rest);
  EXPECT_TRUE(read.rest_given);
  EXPECT_EQ(read.velocity, expected.velocity);
  EXPECT_EQ(read.rod.arc, expected.rod.arc);
  EXPECT_EQ(read.train_frames, 3);
  EXPECT_TRUE(read.warnings.empty());
  Points start(3, 5);
  start << expected.points[0], expected.interior, expected.controllers[0];
  EXPECT_EQ(read.start, start);
}

TEST_F(RecordingFile, IsReadBackWithoutAFile) {
  Recording made = MakeRecording();
  made.name = "rope";
  const Recording expected = ReadRecording(path_), back = AsReadBack(made);
  EXPECT_EQ(back.name, expected.name);
  EXPECT_EQ(back.hash, "");
  ExpectEqual(back.points, expected.points);
  ExpectEqual(back.surface, expected.surface);
  EXPECT_EQ(back.start, expected.start);
  EXPECT_EQ(back.velocity, expected.velocity);
  EXPECT_EQ(back.train_frames, expected.train_frames);
}

TEST_F(RecordingFile, WeightsCountOneOnTheAverageAndNoneIsNotSeen) {
  const std::vector<double> weight = {4, 4, 4, 4, 4, kNan, 4, 0, 8, 4, 4, 4};
  arrays_["weight"] = NpzArray::Doubles({4, 3}, weight.data());
  const Recording read = ReadChanged();
  const double mean = 44 / 10.0;
  EXPECT_EQ(read.weight.size(), 4u);
  EXPECT_DOUBLE_EQ(read.WeightOf(2, 2), 8 / mean);
  EXPECT_DOUBLE_EQ(read.WeightOf(0, 0), 4 / mean);
  EXPECT_TRUE(read.points[2].col(1).array().isNaN().all());
  EXPECT_EQ(MakeRecording().WeightOf(2, 2), 1);
  WriteRecording(read, path_);
  EXPECT_NEAR(ReadRecording(path_).WeightOf(2, 2), 8 / mean, 1e-12);
  SetValue("weight", 4, -1);
  EXPECT_EQ(ErrorOfChanged(), path_ + ": array 'weight' holds -1 at [1, 1], expected 0 or more");
  SetValue("weight", 4, kNan);
  EXPECT_EQ(ErrorOfChanged(), path_ + ": array 'weight' holds nan at [1, 1], expected 0 or more");
  const std::vector<double> none(12, 0);
  arrays_["weight"] = NpzArray::Doubles({4, 3}, none.data());
  EXPECT_EQ(ErrorOfChanged(), path_ + ": array 'weight' is 0 for all that is seen");
  arrays_["weight"] = NpzArray::Doubles({3, 4}, weight.data());
  EXPECT_THAT(ErrorOfChanged(), testing::HasSubstr("array 'weight' has the shape (3, 4)"));
}

TEST_F(RecordingFile, NeedsOnlyPointsControllersAndFps) {
  std::erase_if(arrays_, [](const auto& entry) {
    return entry.first != "points" && entry.first != "controllers" && entry.first != "fps";
  });
  arrays_["controllers"] = NpzArray::Floats({4, 0, 3}, nullptr);
  const Recording read = ReadChanged();
  EXPECT_EQ(read.mass, 0.1);
  EXPECT_EQ(read.warnings,
            std::vector<std::string>{path_ + ": no 'mass' is given, 0.1 kg is assumed"});
  EXPECT_EQ(read.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_FALSE(read.ground.has_value());
  EXPECT_EQ(read.interior_count(), 0);
  EXPECT_EQ(read.controller_count(), 0);
  EXPECT_FALSE(read.rest_given);
  EXPECT_EQ(read.rest, read.start);
  EXPECT_EQ(read.velocity, Points::Zero(3, 3));
  EXPECT_EQ(read.rod.arc.size(), 0);
  EXPECT_TRUE(read.surface.empty());
  EXPECT_TRUE(read.track.empty());
  EXPECT_EQ(read.train_frames, 2);  // 70 % of 4, rounded down
}

TEST_F(RecordingFile, TakesNumbersOfOtherTypes) {
  const int fps = 30;
  const double train_frames = 3;
  arrays_["fps"] = NpzArray::Ints({}, &fps);
  arrays_["train_frames"] = NpzArray::Doubles({}, &train_frames);
  arrays_["points"] = NpzArray::Doubles({4, 3, 3}, arrays_["points"].ToDoubles().data());
  const Recording read = ReadChanged();
  EXPECT_EQ(read.fps, 30);
  EXPECT_EQ(read.train_frames, 3);
  ExpectEqual(read.points, MakeRecording().points);
}

TEST_F(RecordingFile, ScalesTheGroundToAUnitNormal) {
  const std::vector<double> plane{0, 3, 4, 10};
  arrays_["ground"] = NpzArray::Doubles({4}, plane.data());
  EXPECT_TRUE(ReadChanged().ground->isApprox(Eigen::Vector4d(0, 0.6, 0.8, 2), 1e-15));
}

TEST_F(RecordingFile, SaysWhichPointsWerePlaced) {
  arrays_.erase("order");
  for (std::size_t k = 3; k < 6; ++k) SetValue("points", k, kNan);
  const Recording read = ReadChanged();
  EXPECT_TRUE(read.start.allFinite());
  EXPECT_EQ(read.warnings,
            std::vector<std::string>{
                path_ + ": 1 of 3 points, not seen in frame 0, placed from neighbours: 1"});
}

TEST_F(RecordingFile, ReadsCloudsWithoutPointsWhereTheseAreAskedFor) {
  for (const char* of_points : {"points", "interior", "rest", "velocity", "order"}) {
    arrays_.erase(of_points);
  }
  EXPECT_EQ(ErrorOfChanged(), path_ +
                                  ": has clouds ('surface') and no 'points'; `physpring register` "
                                  "makes points of them");
  const Recording clouds = ReadRecordingOrClouds(path_);
  EXPECT_EQ(clouds.point_count(), 0);
  EXPECT_EQ(clouds.frame_count(), 4);
  ExpectEqual(clouds.surface, MakeRecording().surface);
}

TEST(DevelopmentRecordings, AreAllReadWithoutAWarning) {
  if (DevelopmentData().empty()) GTEST_SKIP() << kNoDevelopmentData;
  int count = 0;
  for (const char* folder : {"beam", "cables", "continuum", "practice"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(DevelopmentData() + "/" + folder)) {
      if (entry.path().extension() != ".npz") continue;
      EXPECT_TRUE(ReadRecording(entry.path().string()).warnings.empty()) << entry.path();
      ++count;
    }
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace physpring
