// SPDX-License-Identifier: Apache-2.0
// Springs in the order the kernels want them: blocks of 8, nodes near each other in memory, and as
// far as possible no node twice in a block (a node that was just written need not be waited for).
// The order is a function of the topology only, so results do not depend on the machine or on
// threads.
#ifndef PHYSPRING_TWIN_SPRING_BLOCKS_H_
#define PHYSPRING_TWIN_SPRING_BLOCKS_H_

#include <array>
#include <vector>

#include "twin/spring_mass_system.h"

namespace physpring {

inline constexpr int kSpringBlock = 8;

template <class Real>
struct SpringBlocks {
  // Blocks of 8 springs; the last one is filled up with springs of stiffness 0 between two spare
  // nodes that stand behind all others, at a distance of 1 m.
  std::vector<int> a, b;          // (padded springs)
  std::vector<Real> stiffness;    // k, N/m
  std::vector<Real> rest_length;  // L, m
  std::vector<Real> dashpot;      // c, N s/m
  std::vector<int> spring;        // index in SpringMassSystem::springs; -1 = filling
  int spare_node = 0;             // the two spare nodes are spare_node and spare_node + 1

  int size() const { return static_cast<int>(a.size()); }

  explicit SpringBlocks(const SpringMassSystem& system);

  // Takes over the parameters of a system of the same topology.
  void SetParameters(const SpringMassSystem& system);
};

// Derivatives with respect to the parameters of SpringBlocks, in its order.
template <class Real>
struct SpringBlockGradient {
  std::vector<Real> stiffness, rest_length, dashpot;

  explicit SpringBlockGradient(int size) : stiffness(size), rest_length(size), dashpot(size) {}
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_BLOCKS_H_
