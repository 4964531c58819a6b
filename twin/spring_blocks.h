// SPDX-License-Identifier: Apache-2.0
// Springs in the order the kernels want them: blocks of 4 springs that share their first node. A
// block reads that node once, sums the forces on it before it adds them to memory, and holds no
// node twice. Blocks near each other in the object stand near each other in memory. The order is a
// function of the topology only, so results do not depend on the machine or on threads.
#ifndef PHYSPRING_TWIN_SPRING_BLOCKS_H_
#define PHYSPRING_TWIN_SPRING_BLOCKS_H_

#include <vector>

#include "twin/kernel.h"
#include "twin/spring_mass_system.h"

namespace physpring {

template <class Real>
struct SpringBlocks {
  // Blocks that the springs do not fill are filled with springs of stiffness 0 to a spare node that
  // stands behind all others.
  std::vector<int> a;             // (blocks) the node that the springs of a block share
  std::vector<int> b;             // (4 blocks) the other node of each spring
  std::vector<Real> stiffness;    // (4 blocks) k, N/m
  std::vector<Real> rest_length;  // (4 blocks) L, m
  std::vector<Real> dashpot;      // (4 blocks) c, N s/m
  std::vector<Real> slack;        // (4 blocks) 0, N/m
  std::vector<int> spring;        // (4 blocks) index in SpringMassSystem::springs; -1 = filling
  int spare_node = 0;

  int blocks() const { return static_cast<int>(a.size()); }
  int size() const { return static_cast<int>(b.size()); }

  explicit SpringBlocks(const SpringMassSystem& system);

  SpringView<Real> View() const {
    return {blocks(), a.data(), b.data(), stiffness.data(), rest_length.data(), dashpot.data()};
  }

  // The same with stiffness 0.
  SpringView<Real> Dashpots() const {
    return {blocks(), a.data(), b.data(), slack.data(), rest_length.data(), dashpot.data()};
  }

  // Takes over the parameters of a system of the same topology.
  void SetParameters(const SpringMassSystem& system);
};

// Derivatives with respect to the parameters of SpringBlocks, in its order.
template <class Real>
struct SpringBlockGradient {
  std::vector<Real> stiffness, rest_length, dashpot;

  explicit SpringBlockGradient(int size) : stiffness(size), rest_length(size), dashpot(size) {}

  void Clear() { *this = SpringBlockGradient(static_cast<int>(stiffness.size())); }
  SpringGradientView<Real> View() { return {stiffness.data(), rest_length.data(), dashpot.data()}; }
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_BLOCKS_H_
