// SPDX-License-Identifier: Apache-2.0
#include "trainer/data/fit_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "twin/clock_offset.h"
#include "twin/column_names.h"
#include "twin/error.h"
#include "twin/numbering.h"
#include "twin/recorded_input.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

void ExpectSame(const std::string& path, const std::string& first_path, const char* what,
                double value, double first_value) {
  if (std::abs(value - first_value) <= 1e-6 * std::abs(first_value)) return;
  throw Error(fmt::format("{}: has {} {}, but {} has {}; expected recordings of one object", path,
                          value, what, first_path, first_value));
}

void ExpectSameObject(const std::string& path, const Recording& recording,
                      const std::string& first_path, const Recording& first) {
  ExpectSame(path, first_path, "points", recording.point_count(), first.point_count());
  ExpectSame(path, first_path, "interior particles", recording.interior_count(),
             first.interior_count());
  ExpectSame(path, first_path, "controllers", recording.controller_count(),
             first.controller_count());
  ExpectSame(path, first_path, "frames a second", recording.fps, first.fps);
}

// A twin has springs for one place of each grasp: that of its first recording.
void WarnOfMovedGrasps(const Recording& first, Recording* recording) {
  for (const MovedGrasp& moved : FindMovedGrasps(first.start, *recording)) {
    recording->warnings.push_back(
        fmt::format("recording {}: {} holds the object {:.3g} m from where it does in {}, but the "
                    "twin's springs hold it there: leave this recording out, or train on it alone",
                    recording->name, NameOfController(*recording, moved.controller), moved.distance,
                    first.name));
  }
}

void WarnOfMass(const Recording& first, Recording* recording) {
  constexpr double kAlike = 0.01;  // masses are alike that differ by this part
  if (std::abs(recording->mass - first.mass) <= kAlike * first.mass) return;
  recording->warnings.push_back(fmt::format(
      "recording {}: says that the object weighs {:.4g} kg; the {:.4g} kg of {} are taken",
      recording->name, recording->mass, first.mass, first.name));
}

// Hands that let go are no part of a rod, so that its nodes are compared.
void WarnOfRod(const Recording& first, Recording* recording) {
  const auto edges = [](const Recording& one) {
    return one.rod.empty() ? RodEdges() : RodOfNodes(one.rod, one.particle_count()).edges;
  };
  if (edges(first) == edges(*recording)) return;
  recording->warnings.push_back(
      fmt::format("recording {}: {}; training goes by {}, which {}", recording->name,
                  recording->rod.empty() ? "has no rod" : "has another rod", first.name,
                  first.rod.empty() ? "has none" : "has one"));
}

// Distances that say whether two shapes are the same one, wherever they are.
Eigen::VectorXd DistancesWithin(const Points& shape) {
  const Eigen::Index n = shape.cols();
  Eigen::VectorXd distances(2 * n - 1);
  distances << (shape.colwise() - shape.rowwise().mean()).colwise().norm().transpose(),
      (shape.rightCols(n - 1) - shape.leftCols(n - 1)).colwise().norm().transpose();
  return distances;
}

void WarnOfRest(const Recording& first, Recording* recording) {
  if (!recording->rest_given || recording->particle_count() == 0) return;
  constexpr double kAlike = 1e-5;  // of the largest distance
  const Eigen::VectorXd own =
      DistancesWithin(recording->rest.leftCols(recording->particle_count()));
  const Eigen::VectorXd of_first = DistancesWithin(first.rest.leftCols(first.particle_count()));
  if ((own - of_first).cwiseAbs().maxCoeff() <= kAlike * of_first.maxCoeff()) return;
  recording->warnings.push_back(
      fmt::format("recording {}: its rest shape is not that of {}, by which training goes{}",
                  recording->name, first.name, first.rest_given ? "" : " (frame 0)"));
}

// Whether a particle is seen after frame 0, in the frames for fitting.
bool SeesMotion(const Recording& recording) {
  for (int t = 1; t < recording.train_frames; ++t) {
    if (recording.points[static_cast<std::size_t>(t)].array().isFinite().any()) return true;
  }
  return false;
}

// The last recording is none of those before it under another name: it would count twice.
void ExpectNew(const std::vector<Recording>& recordings,
               const std::vector<RecordingEntry>& entries) {
  for (std::size_t i = 0; i + 1 < recordings.size(); ++i) {
    if (recordings[i].hash != recordings.back().hash) continue;
    throw Error(fmt::format("{}: is the same recording as {}", entries[recordings.size() - 1].path,
                            entries[i].path));
  }
}

// The next recording of `entries`.
void Add(const std::vector<RecordingEntry>& entries, Recording recording, FitData* data) {
  std::vector<Recording>& recordings = data->recordings;
  const RecordingEntry& entry = entries[recordings.size()];
  recordings.push_back(std::move(recording));
  ExpectSameObject(entry.path, recordings.back(), entries[0].path, recordings[0]);
  if (!SeesMotion(recordings.back())) {
    throw Error(fmt::format("{}: no point is seen in frames 1 to {}: there is nothing to fit",
                            entry.path, recordings.back().train_frames - 1));
  }
  ExpectNew(recordings, entries);
  WarnOfMass(recordings[0], &recordings.back());
  WarnOfRod(recordings[0], &recordings.back());
  WarnOfRest(recordings[0], &recordings.back());
  WarnOfOddNumbering(recordings[0], entry.path, &recordings.back());
  WarnOfMovedGrasps(recordings[0], &recordings.back());
  const int own = -static_cast<int>(recordings.size());
  data->continuous_recording.push_back(entry.continuous_recording >= 0 ? entry.continuous_recording
                                                                       : own);
}

}  // namespace

FitData CollectFitData(const std::vector<RecordingEntry>& entries,
                       std::vector<Recording> recordings) {
  FitData data;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Add(entries, std::move(recordings[i]), &data);
  }
  return data;
}

FitData ReadFitData(const std::vector<RecordingEntry>& entries) {
  FitData data;
  for (const RecordingEntry& entry : entries) Add(entries, ReadRecording(entry.path), &data);
  return data;
}

FitData ByClockOf(const Twin& twin, FitData data) {
  for (Recording& recording : data.recordings) UseClockOf(twin, &recording);
  return data;
}

Twin DenseTwin(const Recording& recording, const SpringMassSystem& system, bool controller_velocity,
               std::uint64_t seed) {
  Twin twin;
  twin.levels.emplace_back().system = system;
  twin.points = recording.point_count();
  twin.interior = recording.interior_count();
  twin.rod = recording.rod;
  twin.controller_velocity = controller_velocity;
  twin.late = LateGraspsOf(recording);
  twin.fps = recording.fps;
  twin.gravity = recording.gravity;
  twin.ground = {.known = true, .plane = recording.ground};
  twin.seed = seed;
  return twin;
}

}  // namespace physpring
