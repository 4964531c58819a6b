// SPDX-License-Identifier: Apache-2.0
// A sound recording with every array that there can be, and its file, whose arrays a test changes.
#ifndef PHYSPRING_TESTS_SUPPORT_RECORDING_FILE_H_
#define PHYSPRING_TESTS_SUPPORT_RECORDING_FILE_H_

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/npz.h"
#include "twin/recording.h"

namespace physpring {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Numbers that are exact in float32, all different.
inline Points MakePoints(Eigen::Index count, double first) {
  Points points(3, count);
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    points.data()[i] = first + 0.125 * static_cast<double>(i);
  }
  return points;
}

// 4 frames of 3 points, 1 interior particle and 1 controller: every array that there can be, and
// numbers that are exact in float32.
inline Recording MakeRecording() {
  Recording recording;
  for (int t = 0; t < 4; ++t) {
    Points points(3, 3);
    points << 0, 1, 2, 0, 0, 0.25, 1, 1, 1;
    recording.points.emplace_back(points.array() + 0.125 * t);
    recording.controllers.emplace_back(Points::Constant(3, 1, 1.25 + 0.125 * t));
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
  recording.rod = PlainRod(Eigen::VectorXd::LinSpaced(5, 0, 5));
  recording.train_frames = 3;
  return recording;
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

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_RECORDING_FILE_H_
