// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_blocks.h"

#include <algorithm>
#include <deque>
#include <numeric>

namespace physpring {
namespace {

// Order of the springs in which no block of 8 holds a node twice, as far as that is possible: each
// spring goes to the first of the open blocks where neither of its nodes stands yet.
std::vector<int> ConflictFreeOrder(const std::vector<std::array<int, 2>>& springs) {
  constexpr std::size_t kOpenBlocks = 64;
  std::vector<int> by_node(springs.size());
  std::iota(by_node.begin(), by_node.end(), 0);
  std::stable_sort(by_node.begin(), by_node.end(),
                   [&](int i, int j) { return springs[i] < springs[j]; });

  const auto fits = [&](const std::vector<int>& block, int spring) {
    return std::none_of(block.begin(), block.end(), [&](int other) {
      return springs[other][0] == springs[spring][0] || springs[other][0] == springs[spring][1] ||
             springs[other][1] == springs[spring][0] || springs[other][1] == springs[spring][1];
    });
  };
  std::vector<int> order;
  std::vector<int> left_over;  // of blocks closed before they were full
  std::deque<std::vector<int>> open;
  for (int spring : by_node) {
    auto block = std::find_if(open.begin(), open.end(),
                              [&](const std::vector<int>& b) { return fits(b, spring); });
    if (block == open.end()) {
      if (open.size() == kOpenBlocks) {
        left_over.insert(left_over.end(), open.front().begin(), open.front().end());
        open.pop_front();
      }
      open.emplace_back();
      block = open.end() - 1;
    }
    block->push_back(spring);
    if (block->size() == kSpringBlock) {
      order.insert(order.end(), block->begin(), block->end());
      open.erase(block);
    }
  }
  for (const std::vector<int>& block : open) {
    left_over.insert(left_over.end(), block.begin(), block.end());
  }
  order.insert(order.end(), left_over.begin(), left_over.end());
  return order;
}

}  // namespace

template <class Real>
SpringBlocks<Real>::SpringBlocks(const SpringMassSystem& system)
    : spring(ConflictFreeOrder(system.springs)),
      spare_node(static_cast<int>(system.position.cols())) {
  while (spring.size() % kSpringBlock != 0) spring.push_back(-1);
  for (int e : spring) {
    a.push_back(e < 0 ? spare_node : system.springs[e][0]);
    b.push_back(e < 0 ? spare_node + 1 : system.springs[e][1]);
  }
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
