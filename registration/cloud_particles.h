// SPDX-License-Identifier: Apache-2.0
// Particles that stand for a cloud of points: evenly spread over it, each the mean of the points
// that are nearest to it. Farthest points first, then Lloyd's iteration.
//   Gonzalez, Theoretical Computer Science 38 (1985); Lloyd, IEEE Trans. Inf. Theory 28 (1982).
#ifndef PHYSPRING_REGISTRATION_CLOUD_PARTICLES_H_
#define PHYSPRING_REGISTRATION_CLOUD_PARTICLES_H_

#include "twin/points.h"

namespace physpring {

// The columns of `cloud` that are points: a column of NaN is none.
Points PointsOf(const Points& cloud);

// Its points, or every second, third ... of them, so that there are `most` (>= 1) or fewer.
Points Thinned(const Points& cloud, int most);

// The points that are not far from all others: no more than 6 times as far from their third nearest
// as is usual.
Points WithoutOutliers(const Points& cloud);

// 3 x `count` (>= 1), m; fewer if `cloud` (3 x points, m, finite, one or more) has fewer that are 1
// um apart.
Points SpreadParticles(const Points& cloud, int count);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_CLOUD_PARTICLES_H_
