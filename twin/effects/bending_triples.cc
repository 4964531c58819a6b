// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/bending_triples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace physpring {
namespace {

constexpr double kOpposite = -0.94;  // cosine of the angle between opposite springs, at most

BendingTriple MakeTriple(const SpringMassSystem& system, int a, int b, int c) {
  const Points& x = system.position;
  return {a, b, c, ((x.col(b) - x.col(a)).norm() + (x.col(c) - x.col(b)).norm()) / 2};
}

double BendAt(const Points& x, const BendingTriple& triple) {
  return ((x.col(triple.c) - x.col(triple.b)).normalized() -
          (x.col(triple.b) - x.col(triple.a)).normalized())
      .norm();
}

std::vector<BendingTriple> AlongRod(const SpringMassSystem& system) {
  const std::vector<std::vector<int>> neighbours = RodNeighbours(system.rod);
  std::vector<int> sorted(neighbours.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int i, int j) { return system.rod.arc[i] < system.rod.arc[j]; });
  std::vector<BendingTriple> triples;
  for (const int b : sorted) {
    const std::vector<int>& next = neighbours[b];
    for (std::size_t i = 0; i < next.size(); ++i) {
      for (std::size_t j = i + 1; j < next.size(); ++j) {
        const int a = next[i], c = next[j];
        if (std::min({a, b, c}) >= system.node_count()) continue;
        triples.push_back(MakeTriple(system, a, b, c));
        if (next.size() > 2) triples.back().rest = BendAt(system.position, triples.back());
      }
    }
  }
  return triples;
}

}  // namespace

std::vector<BendingTriple> FindBendingTriples(const SpringMassSystem& system) {
  if (!system.rod.empty()) return AlongRod(system);
  const Points& x = system.position;
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(x.cols()));
  for (const auto& [a, b] : system.springs) {
    neighbours[static_cast<std::size_t>(a)].push_back(b);
    neighbours[static_cast<std::size_t>(b)].push_back(a);
  }
  std::vector<BendingTriple> triples;
  for (int b = 0; b < x.cols(); ++b) {
    const std::vector<int>& around = neighbours[static_cast<std::size_t>(b)];
    // the neighbour that is most opposite to each one, and about as far away: of several on one
    // line rounding would choose
    const auto opposite = [&](int a) {
      int best = -1;
      double least = std::numeric_limits<double>::infinity();
      for (int c : around) {
        const Eigen::Vector3d p = x.col(a) - x.col(b), q = x.col(c) - x.col(b);
        const double cosine = p.dot(q) / (p.norm() * q.norm());
        const double unlike = 2 * (1 + cosine) + std::pow(std::log(p.norm() / q.norm()), 2);
        if (cosine >= kOpposite || unlike >= least) continue;
        least = unlike;
        best = c;
      }
      return best;
    };
    for (int a : around) {
      const int c = opposite(a);
      if (c > a && opposite(c) == a && std::min({a, b, c}) < system.node_count()) {
        triples.push_back(MakeTriple(system, a, b, c));
      }
    }
  }
  return triples;
}

}  // namespace physpring
