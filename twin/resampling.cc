// SPDX-License-Identifier: Apache-2.0
#include "twin/resampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace physpring {
namespace {

// Times so near, in frames, are the same; and what was measured so near a frame stands for it where
// there is no curve.
constexpr double kSameTime = 1e-3, kAboutSameTime = 0.02;
constexpr double kLongestGap = 1.5;  // frames, that a track is followed across
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The last of the times that are not after `time`; -1 if all are.
int LastBefore(const std::vector<double>& times, double time) {
  return static_cast<int>(std::upper_bound(times.begin(), times.end(), time) - times.begin()) - 1;
}

// The slope at k of the parabola through k - 1, k and k + 1, or of the line through those of them
// that are measured.
Eigen::Vector3d Slope(const std::vector<Points>& measured, const std::vector<double>& times, int k,
                      int column) {
  const int count = static_cast<int>(times.size());
  const auto known = [&](int i) {
    return i >= 0 && i < count && measured[i].col(column).allFinite();
  };
  const auto line = [&](int i, int j) -> Eigen::Vector3d {
    return (measured[j].col(column) - measured[i].col(column)) / (times[j] - times[i]);
  };
  if (!known(k - 1)) return line(k, k + 1);
  if (!known(k + 1)) return line(k - 1, k);
  const double before = times[k] - times[k - 1], after = times[k + 1] - times[k];
  return (after * line(k - 1, k) + before * line(k, k + 1)) / (before + after);
}

// Between k and k + 1, both measured.
Eigen::Vector3d OnCurve(const std::vector<Points>& measured, const std::vector<double>& times,
                        int k, int column, double time) {
  const double step = times[k + 1] - times[k], s = (time - times[k]) / step, r = 1 - s;
  return (1 + 2 * s) * r * r * measured[k].col(column) +
         s * r * r * step * Slope(measured, times, k, column) +
         s * s * (3 - 2 * s) * measured[k + 1].col(column) -
         s * s * r * step * Slope(measured, times, k + 1, column);
}

// What was measured nearest to each frame, within half a frame; else NaN.
template <class Frame>
std::vector<Frame> OfNearestTimes(const std::vector<Frame>& measured,
                                  const std::vector<double>& times, const FrameGrid& grid) {
  std::vector<Frame> frames;
  if (measured.empty()) return frames;
  for (int t = 0; t < grid.frames; ++t) {
    const int nearest = Nearest(times, grid.Time(t));
    frames.push_back(measured[nearest]);
    if (std::abs(times[nearest] - grid.Time(t)) * grid.fps > 0.5) frames.back().setConstant(kNaN);
  }
  return frames;
}

}  // namespace

int Nearest(const std::vector<double>& times, double time) {
  const int before = LastBefore(times, time), last = static_cast<int>(times.size()) - 1;
  if (before < 0) return 0;
  if (before == last) return last;
  return time - times[before] <= times[before + 1] - time ? before : before + 1;
}

FrameGrid GridOf(const std::vector<double>& times, double fps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  double step = 1 / fps;
  const double whole = times.back() - times[0];
  if (!(fps > 0)) {
    std::vector<double> sorted = steps;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    step = sorted[sorted.size() / 2];
    double frames = 0;
    for (double one : steps) frames += std::max(1.0, std::round(one / step));
    step = whole / frames;
  }
  return {times[0], 1 / step,
          static_cast<int>(std::min(1e9, std::floor(whole / step + kAboutSameTime))) + 1};
}

double OffGrid(const std::vector<double>& times, const FrameGrid& grid) {
  double sum = 0;
  for (double time : times) {
    const double frames = (time - grid.start) * grid.fps;
    const double off = (frames - std::round(frames)) / grid.fps;
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(times.size()));
}

std::vector<Points> ResampleTracks(const std::vector<Points>& measured,
                                   const std::vector<double>& times, const FrameGrid& grid) {
  const Eigen::Index columns = measured[0].cols();
  std::vector<Points> frames(static_cast<std::size_t>(grid.frames),
                             Points::Constant(3, columns, kNaN));
  for (int t = 0; t < grid.frames; ++t) {
    const double time = grid.Time(t);
    const int nearest = Nearest(times, time), before = LastBefore(times, time);
    const double off = std::abs(times[nearest] - time) * grid.fps;
    if (off <= kAboutSameTime) frames[t] = measured[nearest];
    if (off <= kSameTime || before < 0 || before + 1 == static_cast<int>(times.size())) continue;
    if ((times[before + 1] - times[before]) * grid.fps > kLongestGap) continue;
    for (int i = 0; i < columns; ++i) {
      if (!measured[before].col(i).allFinite() || !measured[before + 1].col(i).allFinite())
        continue;
      frames[t].col(i) = OnCurve(measured, times, before, i, time);
    }
  }
  return frames;
}

std::vector<Points> ResamplePaths(const std::vector<Points>& measured,
                                  const std::vector<double>& times, const FrameGrid& grid) {
  const int columns = static_cast<int>(measured[0].cols());
  std::vector<Points> frames(static_cast<std::size_t>(grid.frames));
  for (int t = 0; t < grid.frames; ++t) {
    const double time = grid.Time(t);
    const int nearest = Nearest(times, time), before = LastBefore(times, time);
    const bool outside = before < 0 || before + 1 == static_cast<int>(times.size());
    if (outside || std::abs(times[nearest] - time) * grid.fps <= kSameTime) {
      frames[t] = measured[nearest];
      continue;
    }
    frames[t].resize(3, columns);
    for (int i = 0; i < columns; ++i) {
      frames[t].col(i) = OnCurve(measured, times, before, i, time);
    }
  }
  return frames;
}

std::vector<Points> ResampleClouds(const std::vector<Points>& measured,
                                   const std::vector<double>& times, const FrameGrid& grid) {
  return OfNearestTimes(measured, times, grid);
}

std::vector<Eigen::MatrixXd> ResampleNumbers(const std::vector<Eigen::MatrixXd>& measured,
                                             const std::vector<double>& times,
                                             const FrameGrid& grid) {
  return OfNearestTimes(measured, times, grid);
}

}  // namespace physpring
