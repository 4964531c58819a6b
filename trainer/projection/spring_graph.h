// SPDX-License-Identifier: Apache-2.0
// The free nodes of a system and the springs between them, as neighbour lists.
#ifndef PHYSPRING_TRAINER_PROJECTION_SPRING_GRAPH_H_
#define PHYSPRING_TRAINER_PROJECTION_SPRING_GRAPH_H_

#include <vector>

#include "twin/spring_mass_system.h"

namespace physpring {

struct SpringGraph {
  struct Link {
    int node;
    double length;  // m, in the reference configuration
  };
  std::vector<std::vector<Link>> links;  // of each free node, ascending
  std::vector<int> part;                 // the connected part that each free node belongs to
  int parts = 0;

  explicit SpringGraph(const SpringMassSystem& system);
  int node_count() const { return static_cast<int>(links.size()); }
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_PROJECTION_SPRING_GRAPH_H_
