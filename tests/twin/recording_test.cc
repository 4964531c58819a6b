// SPDX-License-Identifier: Apache-2.0
#include "twin/recording.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <random>

#include "tests/support/development_data.h"
#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npz.h"

namespace physpring {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Numbers that are exact in float32, all different.
Points MakePoints(Eigen::Index count, double first) {
  Points points(3, count);
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    points.data()[i] = first + 0.125 * static_cast<double>(i);
  }
  return points;
}

// 4 frames of 3 points, 1 interior particle and 1 controller: every array that there can be, and
// numbers that are exact in float32.
Recording MakeRecording() {
  Recording recording;
  for (int t = 0; t < 4; ++t) {
    Points points(3, 3);
    points << 0, 1, 2, 0, 0, 0.25, 1, 1, 1;
    recording.points.emplace_back(points.array() + 0.125 * t);
    recording.controllers.emplace_back(Points::Constant(3, 1, 3 + t));
    recording.surface.emplace_back(Points::Constant(3, 2, t));
    recording.track.emplace_back(Points::Constant(3, 1, -t));
  }
  recording.points[1].col(2).setConstant(kNan);
  recording.surface[0].col(1).setConstant(kNan);
  recording.track[3].col(0).setConstant(kNan);
  recording.fps = 29.97;
  recording.mass = 0.3;
  recording.gravity = {0, 0, -9.8};
  recording.ground = Eigen::Vector4d(0, 0, 1, -0.5);
  recording.interior = Points::Constant(3, 1, 0.5);
  recording.rest = MakePoints(5, 0);
  recording.rest_given = true;
  recording.velocity = MakePoints(4, -2);
  recording.order = Eigen::VectorXd::LinSpaced(5, 0, 0.4);
  recording.train_frames = 3;
  return recording;
}

// Equal, where NaN equals NaN.
void ExpectEqual(const std::vector<Points>& a, const std::vector<Points>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t t = 0; t < a.size(); ++t) {
    ASSERT_EQ(a[t].cols(), b[t].cols());
    EXPECT_TRUE(a[t].array().isNaN().cwiseEqual(b[t].array().isNaN()).all());
    EXPECT_TRUE((a[t].array().isNaN() || a[t].array() == b[t].array()).all());
  }
}

// A sound recording whose arrays a test changes.
class RecordingFile : public testing::Test {
 protected:
  RecordingFile() : path_(folder_.File("rope.npz")) {
    WriteRecording(MakeRecording(), path_);
    arrays_ = ReadNpz(path_);
  }

  Recording ReadChanged() {
    Overwrite(path_, PackNpz(arrays_, path_));
    return ReadRecording(path_);
  }

  std::string ErrorOfChanged() {
    return ErrorOf(path_, [this] { ReadChanged(); });
  }

  // Replaces one value, given by its flat index.
  void SetValue(const std::string& name, std::size_t index, double value) {
    std::vector<double> values = arrays_[name].ToDoubles();
    values.at(index) = value;
    arrays_[name] = NpzArray::Doubles(arrays_[name].shape, values.data());
  }

  TemporaryFolder folder_;
  std::string path_;
  Npz arrays_;
};

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
  EXPECT_EQ(read.order, expected.order);
  EXPECT_EQ(read.train_frames, 3);
  EXPECT_TRUE(read.warnings.empty());
  Points start(3, 5);
  start << expected.points[0], expected.interior, expected.controllers[0];
  EXPECT_EQ(read.start, start);
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
  EXPECT_EQ(read.order.size(), 0);
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

TEST_F(RecordingFile, EveryDamageIsRefused) {
  ExpectEveryDamageIsRefused(path_, [this] { ReadRecording(path_); });
}

TEST_F(RecordingFile, EveryArrayHasOneShape) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    arrays_ = sound;
    arrays_[name].shape.push_back(1);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find("array '" + name + "' has the shape"), std::string::npos) << error;
  }
}

TEST_F(RecordingFile, EveryArrayHoldsNumbers) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    if (name == "train_frames") continue;  // True is 1, which is refused as too few
    arrays_ = sound;
    arrays_[name].type = "|b1";
    arrays_[name].data.assign(array.size(), 1);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find("array '" + name + "' has the type '|b1', expected numbers"),
              std::string::npos)
        << error;
  }
}

TEST_F(RecordingFile, NoArrayHoldsInfinity) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    arrays_ = sound;
    SetValue(name, 0, kInfinity);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find("array '" + name + "' holds inf"), std::string::npos) << error;
  }
}

TEST_F(RecordingFile, OnlyWholePointsMayBeNan) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    const bool may_be_unseen = name == "points" || name == "surface" || name == "track";
    arrays_ = sound;
    SetValue(name, 0, kNan);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find(
                  "array '" + name +
                  (may_be_unseen ? "' holds a point that is partly NaN at [0, 0]" : "' holds nan")),
              std::string::npos)
        << error;
  }
}

TEST_F(RecordingFile, RefusesWhatDisagrees) {
  struct Case {
    const char* name;
    std::vector<std::size_t> shape;
    std::vector<double> values;
    const char* message;
  };
  const std::vector<Case> cases{
      {"points", {1, 1, 3}, {1, 2, 3}, "array 'points' has fewer than 2 frames"},
      {"points", {4, 0, 3}, {}, "array 'points' has no points"},
      {"points", {2, 3}, {1, 2, 3, 4, 5, 6}, "has the shape (2, 3), expected (T, N, 3)"},
      {"points", {1, 2, 4}, {1, 2, 3, 4, 5, 6, 7, 8}, "shape (1, 2, 4), expected (T, N, 3)"},
      {"controllers", {1, 1, 3}, {1, 2, 3}, "expected (T, C, 3) with T = 4"},
      {"surface", {4, 0, 3}, {}, "array 'surface' has no points"},
      {"track", {4, 0, 3}, {}, "array 'track' has no points"},
      {"track", {1, 1, 3}, {1, 2, 3}, "expected (T, K, 3) with T = 4"},
      {"fps", {}, {0}, "array 'fps' holds 0, expected 0.1 to 1000000"},
      {"fps", {}, {1e12}, "array 'fps' holds 1000000000000, expected 0.1"},
      {"fps", {1}, {30}, "array 'fps' has the shape (1,), expected ()"},
      {"mass", {}, {1e-300}, "array 'mass' holds 1e-300, expected 1e-09 to"},
      {"gravity", {2}, {0, -9.81}, "has the shape (2,), expected (3,)"},
      {"ground", {4}, {0, 0, 0, 1}, "array 'ground' holds the normal (0, 0, 0), expected one"},
      {"ground", {3}, {0, 0, 1}, "array 'ground' has the shape (3,), expected (4,)"},
      {"interior", {3}, {1, 2, 3}, "has the shape (3,), expected (M, 3)"},
      {"rest", {1, 3}, {1, 2, 3}, "shape (1, 3), expected (N+M+C, 3) with N+M+C = 5"},
      {"velocity", {1, 3}, {1, 2, 3}, "shape (1, 3), expected (N+M, 3) with N+M = 4"},
      {"order", {2}, {1, 2}, "shape (2,), expected (N+M+C,) with N+M+C = 5"},
      {"order", {5}, {0, 1, 2, 1, 4}, "'order' has point 1 and interior particle 0 at the same"},
      {"train_frames", {}, {1}, "array 'train_frames' holds 1, expected 2 to 4"},
      {"train_frames", {}, {5}, "array 'train_frames' holds 5, expected 2 to 4"},
      {"train_frames", {}, {2.8}, "array 'train_frames' holds 2.8, expected whole numbers"},
      {"train_frames", {1}, {2}, "array 'train_frames' has the shape (1,), expected ()"},
      {"pionts", {}, {1}, "array 'pionts' is not part of a recording, expected only points, con"},
  };
  const Npz sound = arrays_;
  for (const Case& c : cases) {
    arrays_ = sound;
    arrays_[c.name] = NpzArray::Doubles(c.shape, c.values.data());
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find(c.message), std::string::npos) << c.name << " gave " << error;
  }
}

TEST_F(RecordingFile, NeedsWhatCannotBeAssumed) {
  const Npz sound = arrays_;
  for (const char* name : {"points", "controllers", "fps"}) {
    arrays_ = sound;
    arrays_.erase(name);
    EXPECT_EQ(ErrorOfChanged(), path_ + ": array '" + name + "' is missing");
  }
}

TEST_F(RecordingFile, RefusesAPointThatIsNeverSeen) {
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t k = 3; k < 6; ++k) SetValue("points", 9 * t + k, kNan);
  }
  EXPECT_EQ(ErrorOfChanged(),
            path_ + ": array 'points' has point 1, which is not seen in any frame");
}

TEST_F(RecordingFile, RefusesParticlesAtTheSamePlace) {
  const Npz sound = arrays_;
  for (std::size_t k = 0; k < 3; ++k) SetValue("interior", k, k == 2 ? 1 + 5e-8 : k == 0);
  EXPECT_EQ(ErrorOfChanged(), path_ +
                                  ": array 'points' has point 1 and interior particle 0 at the "
                                  "same place, expected 1e-07 m or more");
  SetValue("interior", 2, 1 + 2e-7);
  EXPECT_NO_THROW(ReadChanged());
  arrays_ = sound;
  for (std::size_t k = 0; k < 3; ++k) {
    SetValue("rest", 12 + k, sound.at("rest").ToDoubles()[3 + k]);
  }
  EXPECT_NE(ErrorOfChanged().find("array 'rest' has point 1 and controller 0 at the same place"),
            std::string::npos);
}

TEST_F(RecordingFile, DoesNotWriteWhatItWouldNotRead) {
  const std::string before = ReadFile(path_);
  const auto expect_refused = [&](const Recording& recording, const std::string& message) {
    const std::string error = ErrorOf(path_, [&] { WriteRecording(recording, path_); });
    EXPECT_NE(error.find(message), std::string::npos) << error;
    EXPECT_EQ(ReadFile(path_), before);
  };
  Recording recording = MakeRecording();
  recording.points[2].resize(3, 2);
  expect_refused(recording, "frames differ in their number of points");
  recording = MakeRecording();
  recording.controllers[2](0, 0) = 1e300;  // infinite in float32
  expect_refused(recording, "array 'controllers' holds inf at [2, 0, 0]");
  recording = MakeRecording();
  recording.fps = 0;
  expect_refused(recording, "array 'fps' holds 0");
}

TEST_F(RecordingFile, WritesNoControllersAsNone) {
  Recording recording = MakeRecording();
  recording.controllers.clear();
  recording.rest_given = false;
  recording.order.resize(0);
  WriteRecording(recording, path_);
  EXPECT_EQ(ReadRecording(path_).controllers.size(), 4u);
  EXPECT_EQ(ReadRecording(path_).controller_count(), 0);
}

// Arrays are changed at random and packed again with right checksums, so that every check behind
// the archive is met: whatever is accepted keeps the promises of Recording.
TEST_F(RecordingFile, SurvivesRandomChanges) {
  std::mt19937 random(4);
  const Npz sound = arrays_;
  int accepted = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    arrays_ = sound;
    MutateArrays(arrays_, random);
    try {
      const Recording read = ReadChanged();
      EXPECT_TRUE(read.start.allFinite());
      EXPECT_EQ(read.start.cols(), read.particle_count() + read.controller_count());
      EXPECT_EQ(read.rest.cols(), read.start.cols());
      EXPECT_EQ(read.velocity.cols(), read.particle_count());
      EXPECT_GT(read.fps, 0);
      EXPECT_GT(read.mass, 0);
      EXPECT_TRUE(2 <= read.train_frames && read.train_frames <= read.frame_count());
      ++accepted;
    } catch (const Error& error) {
      ExpectOneLine(path_, error.what());
    }
  }
  EXPECT_GT(accepted, 0);  // the changes are not all hopeless
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
