// SPDX-License-Identifier: Apache-2.0
#include "registration/told_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "registration/followed_body.h"
#include "tracker/soft_match.h"
#include "twin/checks/motion_scale.h"

namespace physpring {
namespace {

constexpr double kFewestTold = 0.05;  // of the points, in frames of a body that is not lost
// A cloud is further off than it may be where it is so many times as far as the first ones, if that
// is so many widths of a match.
constexpr double kFurther = 1.35, kFurtherWidths = 1.25;
constexpr std::size_t kFirst = 5;      // frames, in which no body is lost yet
constexpr double kShortestLoss = 0.2;  // s, and
constexpr int kFewestLost = 3;         // frames
// as soft_match.h names it; the fewest points of a cloud that tell of a particle
constexpr double kNone = 0.05, kFewestPoints = 0.3;

// The frames among which the most more are lost than found, if these are `least` or more. `lost`:
// of each frame, whether it is; none without a cloud.
std::optional<FrameSpan> MostlyLost(const std::vector<std::optional<bool>>& lost, int least) {
  std::optional<FrameSpan> span;
  int most = least - 1, more = 0, first = 0;
  for (std::size_t t = 0; t < lost.size(); ++t) {
    if (!lost[t]) continue;
    if (more <= 0) {
      more = 0;
      first = static_cast<int>(t);
    }
    more += *lost[t] ? 1 : -1;
    if (more <= most) continue;
    most = more;
    span = {first, static_cast<int>(t)};
  }
  return span;
}

// How far a cloud may be from a body that is not lost, m.
double MostDistance(const std::vector<Points>& position, const std::vector<Points>& clouds,
                    double width) {
  std::vector<double> first;
  for (std::size_t t = 1; t < position.size() && first.size() < kFirst; ++t) {
    const double distance = UsualDistance(DistancesToNearest(position[t], clouds[t]));
    if (std::isfinite(distance)) first.push_back(distance);
  }
  if (first.empty()) return kLostWidths * width;
  const double further = kFurther * Quantile(0.5, std::move(first));
  return std::min(kLostWidths * width, std::max(further, kFurtherWidths * width));
}

}  // namespace

RegisteredClouds TellPoints(const Recording& recording, const std::vector<Points>& position) {
  RegisteredClouds registered;
  registered.recording = recording;
  const double width = MatchWidth(position[0]);
  const Eigen::VectorXd alike = Eigen::VectorXd::Ones(recording.particle_count());
  const double most = MostDistance(position, recording.surface, width);
  double seen = 0, all = 0, sum = 0, clouds = 0;
  std::vector<std::optional<bool>> lost(position.size());
  for (std::size_t t = 1; t < position.size(); ++t) {
    Points& points = registered.recording.points[t];
    points.setConstant(std::numeric_limits<double>::quiet_NaN());
    const SoftMatch match = MatchSoftly(position[t], alike, recording.surface[t], width, kNone);
    double seen_now = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (match.count[i] < kFewestPoints) continue;
      ++seen_now;
      points.col(i) = match.target.col(i);
    }
    seen += seen_now;
    all += static_cast<double>(points.cols());
    const double distance = UsualDistance(DistancesToNearest(position[t], recording.surface[t]));
    if (std::isnan(distance)) continue;  // no cloud
    sum += distance;
    ++clouds;
    lost[t] = distance > most || seen_now < kFewestTold * static_cast<double>(points.cols());
  }
  registered.seen = seen / all;
  registered.fit = FitOfClouds(position, recording);
  registered.distance = sum / clouds;
  registered.lost = MostlyLost(
      lost, std::max(kFewestLost, static_cast<int>(std::ceil(kShortestLoss * recording.fps))));
  return registered;
}

}  // namespace physpring
