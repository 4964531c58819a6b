// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_blocks.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace physpring {
namespace {

// A spring at one of its nodes.
struct Incidence {
  int node;  // at the other end
  int spring;
};

struct Block {
  int a;
  std::array<int, kSpringBlock> spring;  // -1 = filling
};

std::vector<std::vector<Incidence>> Incidences(const SpringMassSystem& system) {
  std::vector<std::vector<Incidence>> incidences(system.position.cols());
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    incidences[a].push_back({b, e});
    incidences[b].push_back({a, e});
  }
  return incidences;
}

// Nodes in an order where neighbours are near each other (Cuthill and McKee 1969): breadth first,
// from a node of few springs, nodes of few springs first.
std::vector<int> CuthillMcKee(const std::vector<std::vector<Incidence>>& incidences) {
  const int nodes = static_cast<int>(incidences.size());
  const auto fewer = [&](int i, int j) { return incidences[i].size() < incidences[j].size(); };
  std::vector<int> start(nodes);
  std::iota(start.begin(), start.end(), 0);
  std::stable_sort(start.begin(), start.end(), fewer);

  std::vector<int> order;
  std::vector<bool> seen(nodes, false);
  for (int first : start) {
    if (seen[first]) continue;
    seen[first] = true;
    order.push_back(first);
    for (std::size_t next = order.size() - 1; next < order.size(); ++next) {
      const std::size_t end = order.size();
      for (const Incidence& i : incidences[order[next]]) {
        if (seen[i.node]) continue;
        seen[i.node] = true;
        order.push_back(i.node);
      }
      std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(end), order.end(), fewer);
    }
  }
  return order;
}

// Every node in turn takes the springs that are left at it, in full blocks; what remains is left to
// the nodes that come later. Only where none comes later a block is not filled.
std::vector<Block> MakeBlocks(const SpringMassSystem& system) {
  const auto incidences = Incidences(system);
  const std::vector<int> order = CuthillMcKee(incidences);
  std::vector<int> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);

  std::vector<Block> blocks;
  std::vector<bool> taken(system.springs.size(), false);
  for (int a : order) {
    std::vector<Incidence> left;
    for (const Incidence& i : incidences[a]) {
      if (!taken[i.spring]) left.push_back(i);
    }
    std::sort(left.begin(), left.end(),
              [&](const Incidence& i, const Incidence& j) { return rank[i.node] < rank[j.node]; });
    // those to earlier nodes have nobody else
    const auto later = std::find_if(left.begin(), left.end(),
                                    [&](const Incidence& i) { return rank[i.node] > rank[a]; });
    const std::size_t full = left.size() / kSpringBlock * kSpringBlock;
    if (full >= static_cast<std::size_t>(later - left.begin())) left.resize(full);
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (i % kSpringBlock == 0) {
        blocks.push_back({a, {}});
        blocks.back().spring.fill(-1);
      }
      blocks.back().spring[i % kSpringBlock] = left[i].spring;
      taken[left[i].spring] = true;
    }
  }
  return blocks;
}

}  // namespace

template <class Real>
SpringBlocks<Real>::SpringBlocks(const SpringMassSystem& system)
    : spare_node(static_cast<int>(system.position.cols())) {
  std::vector<Block> made = MakeBlocks(system);
  while (made.size() % kBlocksAtOnce != 0) made.push_back({spare_node, {-1, -1, -1, -1}});
  for (const Block& block : made) {
    a.push_back(block.a);
    for (int e : block.spring) {
      spring.push_back(e);
      // the other end: the two nodes less the shared one
      b.push_back(e < 0 ? spare_node : system.springs[e][0] + system.springs[e][1] - block.a);
    }
  }
  slack.assign(spring.size(), Real(0));
  SetParameters(system);
}

template <class Real>
void SpringBlocks<Real>::SetParameters(const SpringMassSystem& system) {
  stiffness.assign(spring.size(), Real(0));
  rest_length.assign(spring.size(), Real(1));
  dashpot.assign(spring.size(), Real(0));
  for (std::size_t i = 0; i < spring.size(); ++i) {
    if (spring[i] < 0) continue;
    stiffness[i] = static_cast<Real>(system.stiffness[spring[i]]);
    rest_length[i] = static_cast<Real>(system.rest_length[spring[i]]);
    dashpot[i] = static_cast<Real>(system.dashpot[spring[i]]);
  }
}

template struct SpringBlocks<float>;
template struct SpringBlocks<double>;

}  // namespace physpring
