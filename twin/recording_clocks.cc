// SPDX-License-Identifier: Apache-2.0
#include "twin/recording_clocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/resampling.h"

namespace physpring {
namespace {

constexpr double kMostGrowth = 4;       // times as many frames as measured ones
constexpr double kAlikeSpans = 3;       // of two clocks
constexpr double kUnevenFrames = 0.02;  // of a frame, that times are off a fixed rate

// Increasing times, s, since the first one's whole second: a clock may count from 1970.
std::vector<double> ReadTimes(NpzFields& fields, const std::string& name, const std::string& size) {
  const Eigen::VectorXd times = fields.Vector(name, size);
  if (times.size() < 2) fields.Fail(name, "has fewer than 2 times");
  for (Eigen::Index k = 1; k < times.size(); ++k) {
    if (times[k] > times[k - 1]) continue;
    fields.Fail(name, fmt::format("holds {} s at [{}] after {} s, expected times that increase",
                                  times[k], k, times[k - 1]));
  }
  return {times.begin(), times.end()};
}

void ExpectSoundGrid(const NpzFields& fields, const FrameGrid& grid, std::size_t measured) {
  if (!(grid.fps >= kLeastFps && grid.fps <= kMostFps)) {
    fields.Fail("timestamps", fmt::format("makes {:.3g} frames a second, expected {} to {}; times "
                                          "are in seconds",
                                          grid.fps, kLeastFps, kMostFps));
  }
  if (grid.frames <= kMostGrowth * static_cast<double>(measured)) return;
  fields.Fail("timestamps",
              fmt::format("spans {} frames at {:.4g} a second, of which only {} were measured",
                          grid.frames, grid.fps, measured));
}

// The controllers' clock must tell of the frames.
void CheckCover(const NpzFields& fields, const std::string& path, const std::vector<double>& times,
                const FrameGrid& grid, Recording* recording) {
  const double end = grid.Time(grid.frames - 1);
  if (times.back() < grid.start || times[0] > end) {
    fields.Fail("controller_timestamps",
                fmt::format("are from {:.3f} to {:.3f} s, the frames from {:.3f} to {:.3f} s: no "
                            "controller is known in any frame",
                            times[0], times.back(), grid.start, end));
  }
  const double ratio = (times.back() - times[0]) / (end - grid.start);
  if (ratio > kAlikeSpans || ratio < 1 / kAlikeSpans) {
    recording->warnings.push_back(
        fmt::format("{}: the controllers' clock goes on for {:.4g} s, that of the points for "
                    "{:.4g} s: are both "
                    "in seconds?",
                    path, times.back() - times[0], end - grid.start));
  }
  const double before = (times[0] - grid.start) * grid.fps, after = (end - times.back()) * grid.fps;
  const double uncovered = std::max(before, 0.0) + std::max(after, 0.0);
  if (uncovered <= 1) return;
  recording->warnings.push_back(fmt::format(
      "{}: the controllers were not measured in {:.0f} of {} frames at the start or end, and stand "
      "still there",
      path, std::ceil(uncovered), grid.frames));
}

// What of the times a user should know.
void TellOfTimes(const std::string& path, const std::vector<double>& times, const FrameGrid& grid,
                 Recording* recording) {
  const int missing = grid.frames - static_cast<int>(times.size());
  if (missing > 0) {
    recording->notes.push_back(
        fmt::format("{}: {} of {} frames at {:.4g} a second are missing: points are not seen there",
                    path, missing, grid.frames, grid.fps));
  }
  const double off = OffGrid(times, grid);
  if (off * grid.fps < kUnevenFrames) return;
  recording->notes.push_back(fmt::format(
      "{}: frames are {:.1f} ms off a fixed rate: positions are taken from curves through them",
      path, 1e3 * off));
}

// As it was nearest to each frame; where a frame is missing, what held before it and after it.
void ResampleHeld(const std::vector<double>& times, const FrameGrid& grid, Recording* recording) {
  if (recording->held.size() == 0) return;
  const auto measured = recording->held;
  recording->held.resize(grid.frames, measured.cols());
  for (int t = 0; t < grid.frames; ++t) {
    const int near = Nearest(times, grid.Time(t));
    recording->held.row(t) = measured.row(near);
    const double late =
        (times[static_cast<std::size_t>(near)] - grid.Time(t)) * grid.fps;  // frames
    const int other = late > 0 ? near - 1 : near + 1;
    if (std::abs(late) <= 0.5 || other < 0 || other >= measured.rows()) continue;
    recording->held.row(t) = recording->held.row(t) && measured.row(other);
  }
}

std::vector<double> RegularTimes(const Recording& recording) {
  std::vector<double> times;
  for (std::size_t t = 0; t < recording.points.size(); ++t) {
    times.push_back(static_cast<double>(t) / recording.fps);
  }
  return times;
}

}  // namespace

void BringToOneRate(NpzFields& fields, const std::string& path, Recording* recording) {
  recording->two_clocks = fields.Has("controller_timestamps");
  if (!fields.Has("timestamps") && !recording->two_clocks) return;
  const std::vector<double> times =
      fields.Has("timestamps") ? ReadTimes(fields, "timestamps", "T") : RegularTimes(*recording);
  const std::vector<double> controller_times =
      recording->two_clocks ? ReadTimes(fields, "controller_timestamps", "Tc") : times;
  const FrameGrid grid = GridOf(times, recording->fps);
  ExpectSoundGrid(fields, grid, times.size());
  CheckCover(fields, path, controller_times, grid, recording);
  TellOfTimes(path, times, grid, recording);
  recording->fps = grid.fps;
  recording->train_frames = std::clamp(
      static_cast<int>(std::lround(
          (times[static_cast<std::size_t>(recording->train_frames - 1)] - grid.start) * grid.fps)) +
          1,
      2, grid.frames);
  recording->points = ResampleTracks(recording->points, times, grid);
  recording->weight = ResampleNumbers(recording->weight, times, grid);
  recording->controllers = ResamplePaths(recording->controllers, controller_times, grid);
  if (!recording->track.empty()) recording->track = ResampleTracks(recording->track, times, grid);
  recording->surface = ResampleClouds(recording->surface, times, grid);
  recording->force = ResampleNumbers(recording->force, controller_times, grid);
  ResampleHeld(controller_times, grid, recording);
}

}  // namespace physpring
