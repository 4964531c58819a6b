// SPDX-License-Identifier: Apache-2.0
// Where a body can bend: triples (a, b, c) of nodes and controllers, b between a and c, that are
// straight or nearly so in the reference configuration. Along a rod every three neighbours by arc
// length; in other bodies the pairs of springs that leave a node in opposite directions and are
// about as long.
#ifndef PHYSPRING_TWIN_EFFECTS_BENDING_TRIPLES_H_
#define PHYSPRING_TWIN_EFFECTS_BENDING_TRIPLES_H_

#include <array>
#include <vector>

#include "twin/spring_mass_system.h"

namespace physpring {

struct BendingTriple {
  int a, b, c;
  double length;  // (|ab| + |bc|) / 2 in the reference configuration, m
};

// Each has at least one free node. In a fixed order.
std::vector<BendingTriple> FindBendingTriples(const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_BENDING_TRIPLES_H_
