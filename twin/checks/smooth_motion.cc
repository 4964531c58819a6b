// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/smooth_motion.h"

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

constexpr double kShort = 0.03, kLong = 0.1;  // s
constexpr double kMostNumbers = 2e5;          // accelerations that are looked at
constexpr double kSeenPart = 0.75;            // of the points

// Frames in a time, at least 1.
int FramesIn(double time, const Recording& recording) {
  return std::max(1, static_cast<int>(std::lround(time * recording.fps)));
}

// The second difference of column i about frame t.
Eigen::Vector3d Acceleration(const Recording& recording, int t, int step, Eigen::Index i) {
  const std::vector<Points>& x = recording.points;
  return (x[t + step].col(i) - 2 * x[t].col(i) + x[t - step].col(i)) *
         std::pow(recording.fps / step, 2);
}

}  // namespace

std::vector<double> AccelerationSizes(const Recording& recording) {
  const int step = FramesIn(kShort, recording);
  const double numbers = static_cast<double>(recording.frame_count()) * recording.point_count();
  const int every = 1 + static_cast<int>(numbers / kMostNumbers);
  std::vector<double> sizes;
  for (int t = step; t + step < recording.frame_count(); t += every) {
    for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
      const double size = Acceleration(recording, t, step, i).norm();
      if (std::isfinite(size)) sizes.push_back(size);
    }
  }
  return sizes;
}

double MotionOfControllers(const Recording& recording) {
  const int count = recording.controller_count();
  if (count == 0) return 0;
  Points mean = Points::Zero(3, count);
  for (const Points& frame : recording.controllers) mean += frame;
  mean /= recording.frame_count();
  double square = 0;
  for (const Points& frame : recording.controllers) square += (frame - mean).squaredNorm();
  return std::sqrt(square / (static_cast<double>(recording.frame_count()) * count));
}

std::vector<Pull> Pulls(const Recording& recording) {
  const int step = FramesIn(kLong, recording);
  std::vector<Pull> pulls;
  if (recording.controller_count() == 0) return pulls;
  for (int t = step; t + step < recording.frame_count(); ++t) {
    Eigen::Vector3d place = Eigen::Vector3d::Zero(), acceleration = Eigen::Vector3d::Zero();
    double seen = 0;
    for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
      const Eigen::Vector3d a = Acceleration(recording, t, step, i);
      if (!a.allFinite()) continue;
      acceleration += a;
      place += recording.points[t].col(i);
      ++seen;
    }
    if (seen < kSeenPart * recording.point_count()) continue;
    pulls.push_back({place / seen - recording.controllers[t].rowwise().mean(),
                     acceleration / seen - recording.gravity});
  }
  return pulls;
}

}  // namespace physpring
