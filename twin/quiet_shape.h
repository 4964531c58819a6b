// SPDX-License-Identifier: Apache-2.0
// A shape that was measured in one frame, with less noise than that.
#ifndef PHYSPRING_TWIN_QUIET_SHAPE_H_
#define PHYSPRING_TWIN_QUIET_SHAPE_H_

#include "twin/points.h"

namespace physpring {

// `to`, where each column is moved towards where the columns around it in `from` carry it from
// there, as a rigid body, 3 x any number, m; a column that is NaN in either stays. Both say where
// it is, and each counts by its precision. `noise`: standard deviation of a coordinate of `to`, m,
// or more. How far off the others are, and how many of them say it best, is found by leaving each
// column out.
Points QuietShape(const Points& from, const Points& to, double noise);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_QUIET_SHAPE_H_
