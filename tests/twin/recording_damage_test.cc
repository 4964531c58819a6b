// SPDX-License-Identifier: Apache-2.0
// A recording that is damaged or disagrees with itself is refused with one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/recording_file.h"
#include "twin/error.h"
#include "twin/recording.h"

namespace physpring {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

// What trackers write for a lost point; its squares would overflow.
TEST_F(RecordingFile, NoCoordinateIsBeyondAKilometre) {
  const Npz sound = arrays_;
  for (const char* name : {"points", "controllers", "interior", "rest", "surface", "track"}) {
    for (const double value : {-1e155, 1e38, 1001.0}) {
      arrays_ = sound;
      ASSERT_TRUE(arrays_.contains(name));
      SetValue(name, 1, value);
      const std::string error = ErrorOfChanged();
      EXPECT_NE(error.find(fmt::format("array '{}' holds {} at [0,", name, value)),
                std::string::npos)
          << error;
      EXPECT_NE(error.find("expected coordinates within 1000 m"), std::string::npos) << error;
    }
  }
  arrays_ = sound;
  SetValue("rest", 1, -999);
  Overwrite(path_, PackNpz(arrays_, path_));
  EXPECT_EQ(ReadRecording(path_).rest(1, 0), -999);
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
      {"points", {0, 2, 3}, {}, "array 'points' has fewer than 2 frames"},
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
      {"gravity", {3}, {0, 0, -1e200}, "'gravity' holds 1e+200 m/s^2, expected at most 1000"},
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
  recording.rod = {};
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

}  // namespace
}  // namespace physpring
