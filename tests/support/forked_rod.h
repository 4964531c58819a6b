// SPDX-License-Identifier: Apache-2.0
// A rod with two branches, flat: a straight one along x of six columns, two of three from its third
// one, at 60 degrees to either side. Spacing 0.1 m.
//
//              7
//            6
//   0 - 1 - 2 - 3 - 4 - 5
//            8
//              9
#ifndef PHYSPRING_TESTS_SUPPORT_FORKED_ROD_H_
#define PHYSPRING_TESTS_SUPPORT_FORKED_ROD_H_

#include <cmath>

#include "twin/rod.h"

namespace physpring {

inline const RodEdges kForkedEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5},
                                      {2, 6}, {6, 7}, {2, 8}, {8, 9}};

// 3 x 10: 0 to 5 the straight one; 6 and 7, 8 and 9 the branches.
inline Points ForkedPlaces() {
  Points places = Points::Zero(3, 10);
  for (int i = 0; i < 6; ++i) places(0, i) = 0.1 * i;
  const double along = std::cos(M_PI / 3), aside = std::sin(M_PI / 3);
  for (int i = 1; i <= 2; ++i) {
    places.col(5 + i) = places.col(2) + 0.1 * i * Eigen::Vector3d(along, aside, 0);
    places.col(7 + i) = places.col(2) + 0.1 * i * Eigen::Vector3d(along, -aside, 0);
  }
  return places;
}

inline Rod ForkedRod() { return RodOfEdges(kForkedEdges, ForkedPlaces()); }

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_FORKED_ROD_H_
