// SPDX-License-Identifier: Apache-2.0
#include "twin/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "twin/error.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

using Springs = std::set<std::array<int, 2>>;

// Nearer than this two nodes are the same one, m.
constexpr double kCoincident = 1e-7;
// Groups of nodes further apart than this many times the widest spacing are not one object.
constexpr double kWidestGap = 5;

void Join(int i, int j, Springs* springs) { springs->insert({std::min(i, j), std::max(i, j)}); }

// Points on a line at their arc lengths: the neighbour search along a rod.
Points AlongRod(const Eigen::VectorXd& order) {
  Points line = Points::Zero(3, order.size());
  line.row(0) = order.transpose();
  return line;
}

// Joins every column of `from` (index offset + column) to its nearest columns of `nodes`.
void JoinNearest(const Points& nodes, const Points& from, int offset, double radius, int least,
                 int most, Springs* springs) {
  const NeighbourSearch search(nodes);
  for (int i = 0; i < from.cols(); ++i) {
    int joined = 0;
    // one more, because a node finds itself first
    for (const Neighbour& near : search.Nearest(from.col(i), most + 1)) {
      if (near.index == i + offset) continue;
      if (joined == most || (joined >= least && near.distance >= radius)) break;
      Join(i + offset, near.index, springs);
      ++joined;
    }
  }
}

// Joins every node of a rod to the `reach` next ones on either side; the ends of the rod reach as
// far.
void JoinAlongRod(const Eigen::VectorXd& order, int nodes, int reach, Springs* springs) {
  std::vector<int> sorted(nodes);
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](int i, int j) { return order[i] < order[j]; });
  for (int i = 0; i < nodes; ++i) {
    for (int j = i + 1; j <= std::min(i + reach, nodes - 1); ++j) {
      Join(sorted[i], sorted[j], springs);
    }
  }
}

// Group of each node: the smallest index of the nodes it is joined to, over any number of springs.
std::vector<int> Groups(int nodes, const Springs& springs) {
  std::vector<int> group(nodes);
  std::iota(group.begin(), group.end(), 0);
  const auto find = [&](int i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const auto& [a, b] : springs) {
    const int i = find(a), j = find(b);
    group[std::max(i, j)] = std::min(i, j);
  }
  for (int i = 0; i < nodes; ++i) group[i] = find(i);
  return group;
}

// The greatest distance of a node to its nearest neighbour; throws where two coincide.
double WidestSpacing(const Points& nodes, const std::string& where) {
  const NeighbourSearch search(nodes);
  double widest = 0;
  for (int i = 0; i < nodes.cols(); ++i) {
    for (const Neighbour& near : search.Nearest(nodes.col(i), 2)) {
      if (near.index == i) continue;
      if (near.distance < kCoincident) {
        throw Error(fmt::format("{}: particles {} and {} are at the same place; keep one of them",
                                where, std::min(i, near.index), std::max(i, near.index)));
      }
      widest = std::max(widest, near.distance);
    }
  }
  return widest;
}

// Joins the group of node 0 with the group nearest to it until there is one group.
void JoinGroups(const Points& nodes, double widest_spacing, const std::string& where,
                Springs* springs) {
  const int count = static_cast<int>(nodes.cols());
  for (;;) {
    const std::vector<int> group = Groups(count, *springs);
    std::vector<int> inside, outside;
    for (int i = 0; i < count; ++i) (group[i] == group[0] ? inside : outside).push_back(i);
    if (outside.empty()) return;
    const Points targets = nodes(Eigen::all, inside);
    const NeighbourSearch search(targets);
    double nearest = std::numeric_limits<double>::infinity();
    for (int i : outside) nearest = std::min(nearest, search.Nearest(nodes.col(i), 1)[0].distance);
    if (nearest > kWidestGap * widest_spacing) {
      throw Error(
          fmt::format("{}: the particles fall into separate objects, {:.4g} m apart where "
                      "neighbours are at most "
                      "{:.4g} m apart (particle {} is not connected to particle {}); a recording "
                      "holds one object",
                      where, nearest, widest_spacing, outside[0], inside[0]));
    }
    // several springs, so that the joint is no hinge
    for (int i : outside) {
      for (const Neighbour& near : search.Nearest(nodes.col(i), 3)) {
        if (near.distance <= nearest + widest_spacing) Join(i, inside[near.index], springs);
      }
    }
  }
}

void CheckControllers(const Points& nodes, const Points& controllers, const std::string& where) {
  const NeighbourSearch search(nodes);
  for (int c = 0; c < controllers.cols(); ++c) {
    for (const Neighbour& near : search.Nearest(controllers.col(c), 1)) {
      if (near.distance >= kCoincident) continue;
      throw Error(
          fmt::format("{}: controller {} and particle {} are at the same place; keep one of "
                      "them",
                      where, c, near.index));
    }
  }
}

}  // namespace

std::vector<std::array<int, 2>> BuildSprings(const Points& position, int controllers,
                                             const Eigen::VectorXd& order,
                                             const TopologyOptions& options,
                                             const std::string& where) {
  const int nodes = static_cast<int>(position.cols()) - controllers;
  if (nodes < 1 || nodes + controllers < 2) {
    throw Error(
        fmt::format("{}: {} particle(s) and {} controller(s) give no spring; needed are two "
                    "particles, or one and a controller",
                    where, nodes, controllers));
  }
  const bool rod = order.size() > 0;
  const Points searched = rod ? AlongRod(order) : position;
  const Points free = searched.leftCols(nodes);
  const double widest = WidestSpacing(free, where);
  Springs springs;
  if (rod) {
    JoinAlongRod(order, nodes, std::max(1, options.max_neighbours / 2), &springs);
  } else {
    JoinNearest(free, free, 0, options.radius, options.min_neighbours, options.max_neighbours,
                &springs);
  }
  JoinGroups(free, widest, where, &springs);
  const Points hands = searched.rightCols(controllers);
  CheckControllers(free, hands, where);
  JoinNearest(free, hands, nodes, options.controller_radius, options.min_neighbours,
              options.controller_max_neighbours, &springs);
  if (springs.empty()) {
    throw Error(
        fmt::format("{}: no controller is joined to the particle; the search radius for "
                    "controllers, {} m, is too small",
                    where, options.controller_radius));
  }
  return {springs.begin(), springs.end()};
}

Eigen::VectorXd SpringLengths(const std::vector<std::array<int, 2>>& springs,
                              const Points& position, const Eigen::VectorXd& order) {
  Eigen::VectorXd length(springs.size());
  for (std::size_t e = 0; e < springs.size(); ++e) {
    const auto [a, b] = springs[e];
    length[e] = order.size() > 0 ? std::abs(order[a] - order[b])
                                 : (position.col(a) - position.col(b)).norm();
  }
  return length;
}

}  // namespace physpring
