// SPDX-License-Identifier: Apache-2.0
#include "registration/told_points.h"

#include <limits>

#include "registration/followed_body.h"
#include "tracker/soft_match.h"

namespace physpring {
namespace {

constexpr double kLost = 2.5;         // widths of a match, that clouds are from the points
constexpr double kFewestTold = 0.05;  // of the points, in frames of a body that is not lost
// as soft_match.h names it; the fewest points of a cloud that tell of a particle
constexpr double kNone = 0.05, kFewestPoints = 0.3;

}  // namespace

RegisteredClouds TellPoints(const Recording& recording, const std::vector<Points>& position) {
  RegisteredClouds registered{recording};
  const double width = MatchWidth(position[0]);
  double seen = 0, all = 0;
  for (std::size_t t = 1; t < position.size(); ++t) {
    Points& points = registered.recording.points[t];
    points.setConstant(std::numeric_limits<double>::quiet_NaN());
    const SoftMatch match = MatchSoftly(position[t], recording.surface[t], width, kNone);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      ++all;
      if (match.count[i] < kFewestPoints) continue;
      ++seen;
      points.col(i) = match.target.col(i);
    }
  }
  registered.seen = seen / all;
  registered.fit = FitOfClouds(position, recording);
  registered.lost = registered.fit.distance > kLost * width || registered.seen < kFewestTold;
  return registered;
}

}  // namespace physpring
