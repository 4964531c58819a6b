// SPDX-License-Identifier: Apache-2.0
// Which point of a cloud is which marker: each marker is one point at most, and each point one
// marker, so that the squared distances add up to the least. A marker without a point costs the
// square of the reach.
//   Kuhn, The Hungarian method for the assignment problem, Naval Research Logistics 2 (1955).
#ifndef PHYSPRING_REGISTRATION_NAME_MARKERS_H_
#define PHYSPRING_REGISTRATION_NAME_MARKERS_H_

#include <vector>

#include "twin/points.h"

namespace physpring {

// For each marker the column of `cloud` (3 x points, m, finite) that it is, or -1. `markers`: where
// they are expected, 3 x markers, m, finite. A point is none of them where it is further than
// `reach` (m) away.
std::vector<int> NameMarkers(const Points& markers, const Points& cloud, double reach);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_NAME_MARKERS_H_
