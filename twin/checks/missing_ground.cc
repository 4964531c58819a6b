// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/missing_ground.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace physpring {
namespace {

constexpr double kFlat = 0.2;       // its height, of its size
constexpr double kLifted = 0.1;     // what its height grows by, of its size
constexpr double kNoLower = 0.05;   // of its size
constexpr double kOutliers = 0.02;  // of the points of a frame

// Heights of the points that are seen.
std::vector<double> Heights(const Points& points, const Eigen::Vector3d& up) {
  std::vector<double> heights;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double height = up.dot(points.col(i));
    if (std::isfinite(height)) heights.push_back(height);
  }
  return heights;
}

}  // namespace

std::string MissingGround(const Recording& recording, const MotionScale& scale) {
  if (recording.ground || recording.gravity.norm() == 0) return "";
  const Eigen::Vector3d up = -recording.gravity.normalized();
  const std::vector<double> start = Heights(recording.start.leftCols(recording.point_count()), up);
  const double lowest = Quantile(kOutliers, start), highest = Quantile(1 - kOutliers, start);
  if (highest - lowest > kFlat * scale.size) return "";

  const double no_lower = std::max(kNoLower * scale.size, 4 * scale.noise);
  double upright = 0;  // its height, at most
  for (const Points& frame : recording.points) {
    const std::vector<double> heights = Heights(frame, up);
    if (heights.empty()) continue;
    if (Quantile(kOutliers, heights) < lowest - no_lower) return "";
    upright = std::max(upright, Quantile(1 - kOutliers, heights) - Quantile(kOutliers, heights));
  }
  if (upright < highest - lowest + kLifted * scale.size) return "";
  return fmt::format(
      "the object lies flat at a height of {:.3g} m at the start and is never lower, but there is "
      "no ground: if it lies on something, 'ground' must say where",
      lowest);
}

}  // namespace physpring
