// SPDX-License-Identifier: Apache-2.0
#include "trainer/projection/spring_graph.h"

#include <algorithm>

namespace physpring {

SpringGraph::SpringGraph(const SpringMassSystem& system)
    : links(system.node_count()), part(system.node_count(), -1) {
  for (const auto& [a, b] : system.springs) {
    if (std::max(a, b) >= system.node_count()) continue;
    const double length = (system.position.col(b) - system.position.col(a)).norm();
    links[a].push_back({b, length});
    links[b].push_back({a, length});
  }
  for (auto& list : links) {
    std::sort(list.begin(), list.end(), [](Link i, Link j) { return i.node < j.node; });
  }
  std::vector<int> open;
  for (int first = 0; first < node_count(); ++first) {
    if (part[first] >= 0) continue;
    part[first] = parts;
    open.assign(1, first);
    while (!open.empty()) {
      const int node = open.back();
      open.pop_back();
      for (const Link& link : links[node]) {
        if (part[link.node] >= 0) continue;
        part[link.node] = parts;
        open.push_back(link.node);
      }
    }
    ++parts;
  }
}

}  // namespace physpring
