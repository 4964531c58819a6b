// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_POINTS_H_
#define PHYSPRING_TWIN_POINTS_H_

#include <Eigen/Core>

namespace physpring {

// Positions [m] or velocities [m/s] of a set of points, one column each (3 x points).
using Points = Eigen::Matrix3Xd;

constexpr double kFarAway = 1e3;  // a body that moved this far has diverged, m

inline bool IsFarAway(const Points& position) {
  return !position.allFinite() ||
         (position.size() > 0 && position.cwiseAbs().maxCoeff() > kFarAway);
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_POINTS_H_
