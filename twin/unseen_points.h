// SPDX-License-Identifier: Apache-2.0
// Where a point was in frame 0 that is not seen there: its neighbours moved as a rigid body from a
// shape that is known (stress-free positions, else the first frame that sees the point) to frame 0,
//   x_i = c + R (r_i - c_r),   R = argmin sum_j |x_j - c - R (r_j - c_r)|^2,
// over the nearest neighbours j; the point moved with them.
#ifndef PHYSPRING_TWIN_UNSEEN_POINTS_H_
#define PHYSPRING_TWIN_UNSEEN_POINTS_H_

#include <vector>

#include "twin/recording.h"

namespace physpring {

// Fills the columns of `recording.start` that are NaN, using `rest` if `rest_given` and else the
// frames; every point must be seen in some frame. A point without any neighbour that is known in
// both shapes is left where it is first seen. Returns the columns that were filled.
std::vector<int> PlaceUnseenPoints(Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_UNSEEN_POINTS_H_
