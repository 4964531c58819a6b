// SPDX-License-Identifier: Apache-2.0
// The search radius that gives an inner particle about a wanted number of springs. Bodies are
// mostly sampled on something like a grid, where neighbours come in shells; a count would cut a
// shell in two and join a particle to some of its equals but not to others. The radius therefore
// lies in a gap between shells.
#ifndef PHYSPRING_TRAINER_BODIES_SPRING_RADIUS_H_
#define PHYSPRING_TRAINER_BODIES_SPRING_RADIUS_H_

#include "twin/points.h"

namespace physpring {

// Radius, m, within which an inner one of `particles` (3 x M, M >= 2, m) has between 4/5 and 5/4 of
// `neighbours` (>= 1) others. It is chosen so that the fewest pairs of particles are about that far
// apart.
double SpringRadius(const Points& particles, int neighbours);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_SPRING_RADIUS_H_
