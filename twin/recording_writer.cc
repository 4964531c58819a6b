// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <vector>

#include "twin/error.h"
#include "twin/npz_fields.h"
#include "twin/recorded_rod.h"
#include "twin/recording.h"

namespace physpring {
namespace {

// (columns, 3)
NpzArray StorePositions(const Points& positions) {
  return NpzArray::Floats({ExtentOf(positions.cols()), 3}, positions.data());
}

// Frames of rows x columns as (T, columns, rows), or (T, columns) of one row.
NpzArray StoreNumbers(const std::vector<Eigen::MatrixXd>& frames) {
  std::vector<double> numbers;
  for (const Eigen::MatrixXd& frame : frames) {
    numbers.insert(numbers.end(), frame.data(), frame.data() + frame.size());
  }
  std::vector<std::size_t> shape{frames.size(), ExtentOf(frames[0].cols())};
  if (frames[0].rows() > 1) shape.push_back(ExtentOf(frames[0].rows()));
  return NpzArray::Doubles(shape, numbers.data());
}

NpzArray StoreHeld(const Recording& recording) {
  std::vector<int> held;
  for (int t = 0; t < recording.held.rows(); ++t) {
    for (int c = 0; c < recording.held.cols(); ++c) held.push_back(recording.held(t, c));
  }
  return NpzArray::Ints({ExtentOf(recording.held.rows()), ExtentOf(recording.held.cols())},
                        held.data());
}

// The times of the frames, s.
Eigen::VectorXd FrameTimes(const Recording& recording) {
  return Eigen::VectorXd::LinSpaced(recording.frame_count(), 0,
                                    (recording.frame_count() - 1) / recording.fps);
}

}  // namespace

Npz StoreRecording(const Recording& recording) {
  Npz arrays;
  if (recording.point_count() > 0) arrays["points"] = StoreFrames(recording.points);
  const std::vector<Points> no_controllers(recording.points.size(), Points(3, 0));
  arrays["controllers"] =
      StoreFrames(recording.controllers.empty() ? no_controllers : recording.controllers);
  arrays["fps"] = NpzArray::Doubles({}, &recording.fps);
  arrays["mass"] = NpzArray::Doubles({}, &recording.mass);
  arrays["gravity"] = NpzArray::Doubles({3}, recording.gravity.data());
  arrays["train_frames"] = NpzArray::Ints({}, &recording.train_frames);
  if (recording.ground) arrays["ground"] = NpzArray::Doubles({4}, recording.ground->data());
  if (recording.interior.cols() > 0) arrays["interior"] = StorePositions(recording.interior);
  if (recording.rest_given) arrays["rest"] = StorePositions(recording.rest);
  if (!recording.velocity.isZero(0)) arrays["velocity"] = StorePositions(recording.velocity);
  StoreRod(recording, &arrays);
  if (recording.object.size() > 0) {
    const Eigen::VectorXi declared = recording.object.head(recording.particle_count());
    arrays["object"] = NpzArray::Ints({ExtentOf(declared.size())}, declared.data());
  }
  if (recording.held.size() > 0) arrays["held"] = StoreHeld(recording);
  if (!recording.weight.empty()) arrays["weight"] = StoreNumbers(recording.weight);
  if (!recording.force.empty()) arrays["force"] = StoreNumbers(recording.force);
  if (recording.two_clocks) {
    const Eigen::VectorXd times = FrameTimes(recording);
    arrays["controller_timestamps"] = NpzArray::Doubles({ExtentOf(times.size())}, times.data());
  }
  if (!recording.surface.empty()) arrays["surface"] = StoreFrames(recording.surface);
  if (!recording.track.empty()) arrays["track"] = StoreFrames(recording.track);
  return arrays;
}

void WriteRecording(const Recording& recording, const std::string& path) {
  Npz arrays;
  try {
    arrays = StoreRecording(recording);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
  ParseRecording(arrays, path);  // what the reader would refuse is not written
  WriteNpz(arrays, path);
}

Recording AsReadBack(const Recording& recording) {
  return ParseRecording(StoreRecording(recording), recording.name);
}

}  // namespace physpring
