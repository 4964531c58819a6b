// SPDX-License-Identifier: Apache-2.0
// Where a body can bend: triples (a, b, c) of nodes and controllers, b between a and c. Along a rod
// every column with each two next to it, so at a joint those of each two branches; in other bodies
// the pairs of springs that leave a node in opposite directions and are about as long.
#ifndef PHYSPRING_TWIN_EFFECTS_BENDING_TRIPLES_H_
#define PHYSPRING_TWIN_EFFECTS_BENDING_TRIPLES_H_

#include <array>
#include <vector>

#include "twin/spring_mass_system.h"

namespace physpring {

struct BendingTriple {
  int a, b, c;
  double length;  // (|ab| + |bc|) / 2 in the reference configuration, m
  // How much it is bent at rest, |kappa| (bend_effect.h): at a joint of a rod as in the reference
  // configuration, elsewhere 0.
  double rest = 0;
};

// Each has at least one free node. In a fixed order.
std::vector<BendingTriple> FindBendingTriples(const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_BENDING_TRIPLES_H_
