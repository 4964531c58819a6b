// SPDX-License-Identifier: Apache-2.0
#include "bench/rope.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

#include "twin/neighbours.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr double kLength = 1, kRadius = 0.02;  // m
constexpr double kMass = 0.1;                  // kg

Points Scatter(int nodes) {
  std::mt19937_64 generator(1);
  const auto uniform = [&] { return Uniform(&generator); };
  Points points(3, nodes);
  for (int i = 0; i < nodes; ++i) {
    const double x = kLength * uniform();
    const double radius = kRadius * std::sqrt(uniform()), angle = 2 * M_PI * uniform();
    points.col(i) << x, radius * std::cos(angle), radius * std::sin(angle);
  }
  points.row(2).array() -= points.row(2).minCoeff();
  return points;
}

// The `count` shortest springs to nodes among the nearest of each.
std::vector<std::array<int, 2>> Join(const Points& points, int count) {
  struct Candidate {
    double length;
    std::array<int, 2> ends;
  };
  const NeighbourSearch search(points);
  const int nodes = static_cast<int>(points.cols());
  std::vector<Candidate> candidates;
  for (int i = 0; i < nodes; ++i) {
    for (const Neighbour& n : search.Nearest(points.col(i), 4 * count / nodes + 2)) {
      if (n.index > i) candidates.push_back({n.distance, {i, n.index}});
    }
  }
  assert(static_cast<int>(candidates.size()) >= count);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& p, const Candidate& q) { return p.length < q.length; });
  candidates.resize(count);
  std::vector<std::array<int, 2>> springs;
  for (const Candidate& candidate : candidates) springs.push_back(candidate.ends);
  std::sort(springs.begin(), springs.end());
  return springs;
}

}  // namespace

SpringMassSystem MakeRope(int nodes, int springs) {
  SpringMassSystem rope;
  rope.position = Scatter(nodes);
  rope.springs = Join(rope.position, springs);
  const double mass = kMass / nodes;
  rope.mass.setConstant(nodes, mass);
  rope.rest_length.resize(springs);
  for (int e = 0; e < springs; ++e) {
    const auto [a, b] = rope.springs[e];
    rope.rest_length[e] = (rope.position.col(a) - rope.position.col(b)).norm();
  }
  rope.stiffness = 3e4 * mass * rope.rest_length.cwiseMax(0.005).cwiseInverse();
  rope.dashpot.setConstant(springs, 100 * mass);
  rope.drag = 3;
  rope.contact_radius.setZero(nodes);
  return rope;
}

}  // namespace physpring
