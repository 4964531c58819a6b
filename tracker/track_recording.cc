// SPDX-License-Identifier: Apache-2.0
#include "tracker/track_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "tracker/tracked_body.h"
#include "tracker/tracker_bank.h"
#include "twin/checks/motion_scale.h"
#include "twin/error.h"
#include "twin/neighbours.h"
#include "twin/predict.h"
#include "twin/recorded_input.h"
#include "twin/rotation.h"

namespace physpring {
namespace {

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();

bool MeasuredAfterStart(const Recording& recording, int point) {
  return std::any_of(recording.points.begin() + 1, recording.points.end(),
                     [&](const Points& frame) { return frame.col(point).allFinite(); });
}

// The points that are not told, and judged by: a part of them, drawn by the seed; with clouds all
// that are measured.
std::vector<int> Hidden(const Recording& recording, const TrackOptions& options) {
  std::vector<int> points(static_cast<std::size_t>(recording.point_count()));
  std::iota(points.begin(), points.end(), 0);
  if (options.cloud) {
    std::erase_if(points, [&](int i) { return !MeasuredAfterStart(recording, i); });
    return points;
  }
  std::mt19937_64 generator(options.seed);
  for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[generator() % i]);
  points.resize(static_cast<std::size_t>(options.hide * static_cast<double>(points.size())));
  std::sort(points.begin(), points.end());
  return points;
}

// What is told of each frame: the cloud, or the points but the hidden ones.
std::vector<FrameMeasurement> ToldOf(const Recording& recording, const std::vector<int>& hidden,
                                     bool cloud) {
  std::vector<FrameMeasurement> told(recording.points.size());
  for (std::size_t t = 0; t < told.size(); ++t) {
    if (cloud) {
      told[t].cloud = recording.surface[t];
      continue;
    }
    told[t].named = recording.points[t];
    if (!recording.weight.empty()) told[t].weight = recording.weight[t].row(0);
    for (int i : hidden) told[t].named.col(i).setConstant(kNotSeen);
  }
  return told;
}

// Standard deviation of a measured coordinate, m; 0 of clouds, whose tracker needs none.
double NoiseOf(const std::vector<FrameMeasurement>& told) {
  constexpr double kLeast = 1e-6;
  std::vector<Points> named;
  for (const FrameMeasurement& frame : told) named.push_back(frame.named);
  return named[0].cols() > 0 ? std::max(kLeast, MeasurementNoise(named)) : 0;
}

// Points that go along with the nearest ones that are told in a frame, as a rigid body.
class Interpolation {
 public:
  Interpolation(const Points& start, const std::vector<int>& points, const std::vector<int>& told)
      : start_(start), points_(points), told_(told), search_(Points(start(Eigen::all, told))) {}

  // 3 x start's columns; those that are not asked for are where they were at the start.
  Points In(const Points& measured) const {
    constexpr int kLooked = 24;
    constexpr std::size_t kNearest = 8;
    Points placed = start_;
    for (int point : points_) {
      std::vector<int> near;
      for (const Neighbour& one : search_.Nearest(start_.col(point), kLooked)) {
        const int i = told_[static_cast<std::size_t>(one.index)];
        if (near.size() < kNearest && measured.col(i).allFinite()) near.push_back(i);
      }
      if (near.empty()) continue;
      placed.col(point) =
          MoveRigidly(start_(Eigen::all, near), measured(Eigen::all, near), start_.col(point));
    }
    return placed;
  }

 private:
  const Points& start_;
  const std::vector<int>&points_, &told_;
  NeighbourSearch search_;
};

// The mean distance of the points from where they were measured after frame 0; NaN without any.
double ErrorOf(const std::vector<Points>& position, const Recording& recording,
               const std::vector<int>& points) {
  double sum = 0, count = 0;
  for (std::size_t t = 1; t < position.size(); ++t) {
    for (int i : points) {
      const double distance = (position[t].col(i) - recording.points[t].col(i)).norm();
      if (!std::isfinite(distance)) continue;
      sum += distance;
      ++count;
    }
  }
  return sum / count;
}

// Without measurements; none where that motion diverges.
std::vector<Points> PredictedOrNone(const Twin& twin, const Recording& recording) {
  try {
    return Predict(twin, 0, recording, {});
  } catch (const Error&) {
    return {};
  }
}

double InterpolationError(const Recording& recording, const std::vector<int>& hidden) {
  std::vector<int> told;
  for (int i = 0; i < recording.point_count(); ++i) {
    if (!std::binary_search(hidden.begin(), hidden.end(), i)) told.push_back(i);
  }
  if (told.empty() || hidden.empty()) return kNotSeen;
  const Points start = recording.start.leftCols(recording.point_count());
  const Interpolation interpolation(start, hidden, told);
  std::vector<Points> placed;
  for (const Points& measured : recording.points) placed.push_back(interpolation.In(measured));
  return ErrorOf(placed, recording, hidden);
}

void ExpectSomethingToFollow(const Recording& recording, const TrackOptions& options) {
  if (options.cloud && recording.surface.empty()) {
    throw Error(fmt::format("recording {}: has no 'surface' to follow", recording.name));
  }
  if (options.cloud &&
      std::none_of(recording.surface.begin(), recording.surface.end(),
                   [](const Points& cloud) { return cloud.array().isFinite().any(); })) {
    throw Error(fmt::format("recording {}: has no point in 'surface'", recording.name));
  }
}

}  // namespace

std::vector<double> DistancesToNearest(const Points& nodes, const Points& cloud) {
  const NeighbourSearch search(nodes);
  std::vector<double> distances;
  for (const auto& point : cloud.colwise()) {
    if (point.allFinite()) distances.push_back(search.Nearest(point, 1)[0].distance);
  }
  return distances;
}

double UsualDistance(std::vector<double> distances) {
  constexpr double kNearest = 0.8;
  if (distances.empty()) return kNotSeen;
  std::sort(distances.begin(), distances.end());
  const auto count = std::max(1.0, kNearest * static_cast<double>(distances.size()));
  const auto end = distances.begin() + static_cast<std::ptrdiff_t>(count);
  return std::accumulate(distances.begin(), end, 0.0) /
         static_cast<double>(end - distances.begin());
}

CloudFit FitOfClouds(const std::vector<Points>& position, const Recording& recording) {
  const std::size_t frames = position.size();
  const std::size_t last_second =
      std::min(frames - 1, static_cast<std::size_t>(std::ceil(recording.fps)));
  std::vector<double> distances;
  for (std::size_t t = frames - last_second; t < frames; ++t) {
    const std::vector<double> of_frame = DistancesToNearest(position[t], recording.surface[t]);
    distances.insert(distances.end(), of_frame.begin(), of_frame.end());
  }
  const bool alone = position[0].cols() < 2;
  return {UsualDistance(std::move(distances)), alone ? 0 : MedianSpacing(position[0])};
}

TrackedMotion TrackRecording(const Twin& twin, const Recording& recording,
                             const TrackOptions& options) {
  ExpectSameObject(twin, recording);
  ExpectSomethingToFollow(recording, options);
  const SpringMassSystem& system = twin.levels[0].system;
  const TrackedBody body = BodyToTrack(system, recording.fps, options.substeps);
  TrackedMotion motion;
  motion.substeps = body.substeps;
  motion.softened = body.softened;
  motion.hidden = Hidden(recording, options);
  const std::vector<FrameMeasurement> told = ToldOf(recording, motion.hidden, options.cloud);
  TrackerBank tracker(
      body.system, EnvironmentOf(recording),
      {1 / recording.fps, body.substeps, twin.controller_velocity, LateGraspsOf(recording)},
      NoiseOf(told), recording.point_count(), recording.start.leftCols(recording.particle_count()),
      recording.velocity);
  const double delay = ControllerDelay(system);
  const auto begin = std::chrono::steady_clock::now();
  motion.position.push_back(tracker.best().position());
  motion.velocity.push_back(tracker.best().velocity());
  for (int frame = 1; frame < recording.frame_count(); ++frame) {
    tracker.Advance(RecordedInput(recording, frame, delay), told[static_cast<std::size_t>(frame)]);
    motion.position.push_back(tracker.best().position());
    motion.velocity.push_back(tracker.best().velocity());
    if (motion.position.back().allFinite()) continue;
    throw Error(fmt::format("recording {}: the tracked motion diverges in frame {}", recording.name,
                            frame));
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  motion.frames_per_second = (recording.frame_count() - 1) / elapsed.count();
  motion.errors = {ErrorOf(motion.position, recording, motion.hidden), kNotSeen,
                   options.cloud ? kNotSeen : InterpolationError(recording, motion.hidden)};
  if (options.cloud) motion.cloud = FitOfClouds(motion.position, recording);
  if (motion.hidden.empty() && !options.cloud) return motion;
  const std::vector<Points> predicted = PredictedOrNone(twin, recording);
  if (predicted.empty()) return motion;
  motion.errors.predicted = ErrorOf(predicted, recording, motion.hidden);
  if (options.cloud) motion.predicted_cloud_distance = FitOfClouds(predicted, recording).distance;
  return motion;
}

}  // namespace physpring
