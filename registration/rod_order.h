// SPDX-License-Identifier: Apache-2.0
// The order of points along a rod, where nothing says it but how they move. Points that are next to
// each other never come far apart, those of two parts of a rod that meet once do. So two points are
// as far apart along it as they are at their farthest.
#ifndef PHYSPRING_REGISTRATION_ROD_ORDER_H_
#define PHYSPRING_REGISTRATION_ROD_ORDER_H_

#include <string>
#include <vector>

#include "twin/points.h"

namespace physpring {

// Arc lengths, (columns), m, of two columns or more, from one end of the rod to the other: along
// the shortest tree that joins all columns of `frames` (3 x columns, m; NaN: not seen). Distances
// are those that are exceeded in one frame of twenty. Throws Error where that tree has branches,
// or two columns are never seen together, beginning with `where`.
Eigen::VectorXd RodOrder(const std::vector<Points>& frames, const std::string& where);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_ROD_ORDER_H_
