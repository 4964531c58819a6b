// SPDX-License-Identifier: Apache-2.0
#include "twin/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
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

Error CoincidentParticles(const std::string& where, int a, int b) {
  return Error(fmt::format("{}: particles {} and {} are at the same place; keep one of them", where,
                           std::min(a, b), std::max(a, b)));
}

Error CoincidentController(const std::string& where, int controller, int particle) {
  return Error(
      fmt::format("{}: controller {} and particle {} are at the same place; keep one of "
                  "them",
                  where, controller, particle));
}

void Join(int i, int j, Springs* springs) { springs->insert({std::min(i, j), std::max(i, j)}); }

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

// Joins every node to the `reach` next ones on each way along a rod of nodes alone.
void JoinAlongRod(const Rod& rod, int reach, Springs* springs) {
  const std::vector<std::vector<int>> neighbours = RodNeighbours(rod);
  for (int start = 0; start < std::ssize(neighbours); ++start) {
    std::set<int> reached = {start};
    std::vector<int> last = {start};
    for (int step = 0; step < reach; ++step) {
      std::vector<int> next;
      for (int i : last) {
        for (int j : neighbours[i]) {
          if (!reached.insert(j).second) continue;
          next.push_back(j);
          Join(start, j, springs);
        }
      }
      last = next;
    }
  }
}

void JoinAll(const std::vector<int>& one, const std::vector<int>& other, Springs* springs) {
  for (int a : one) {
    for (int b : other) {
      if (a != b) Join(a, b, springs);
    }
  }
}

// Joins the nodes around each joint to each other, so that the joint keeps its shape: those up to
// `most` steps from it, of each two branches.
void BraceJoints(const Rod& rod, int most, Springs* springs) {
  const std::vector<std::vector<int>> neighbours = RodNeighbours(rod);
  std::map<int, std::vector<std::vector<int>>> branches;  // of each joint
  for (std::vector<int> way : RodWays(rod)) {
    const std::ptrdiff_t reach = std::min(std::ssize(way) - 1, std::ptrdiff_t{most});
    for (int end = 0; end < 2; ++end) {
      if (neighbours[way[0]].size() > 2) {
        branches[way[0]].emplace_back(way.begin() + 1, way.begin() + 1 + reach);
      }
      std::reverse(way.begin(), way.end());
    }
  }
  for (const auto& [joint, own] : branches) {
    for (auto other = own.begin(); other != own.end(); ++other) {
      for (auto one = own.begin(); one != other; ++one) JoinAll(*one, *other, springs);
    }
  }
}

Springs SpringsAlong(const Rod& rod, int reach, int joint_reach) {
  Springs springs;
  JoinAlongRod(rod, reach, &springs);
  BraceJoints(rod, joint_reach, &springs);
  return springs;
}

// Joins every controller to the nodes that are nearest along a rod, or beside it.
void JoinNearestOnRod(const Rod& rod, const Points& position, int nodes,
                      const TopologyOptions& options, const std::string& where, Springs* springs) {
  const RodLengths lengths(rod);
  for (int c = nodes; c < position.cols(); ++c) {
    std::vector<Neighbour> near;
    for (int i = 0; i < nodes; ++i) near.push_back({i, lengths.Between(c, i, position)});
    std::stable_sort(near.begin(), near.end(), [](const Neighbour& a, const Neighbour& b) {
      return a.distance < b.distance;
    });
    if (near[0].distance < kCoincident) throw CoincidentController(where, c - nodes, near[0].index);
    for (int i = 0; i < std::min(nodes, options.controller_max_neighbours); ++i) {
      if (i >= options.min_neighbours && near[i].distance >= options.controller_radius) break;
      Join(c, near[i].index, springs);
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
        throw CoincidentParticles(where, i, near.index);
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
                      "{:.4g} m apart (particle {} is not connected to particle {}); does frame 0 "
                      "show all of one object, without a hole?",
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

// The longest edge between nodes; throws where two coincide.
double LongestEdge(const Rod& rod, const Points& position, const std::string& where) {
  const RodLengths lengths(rod);
  double longest = 0;
  for (const auto& [a, b] : rod.edges) {
    const double length = lengths.Between(a, b, position);
    if (length < kCoincident) throw CoincidentParticles(where, a, b);
    longest = std::max(longest, length);
  }
  return longest;
}

void CheckControllers(const Points& nodes, const Points& controllers, const std::string& where) {
  const NeighbourSearch search(nodes);
  for (int c = 0; c < controllers.cols(); ++c) {
    for (const Neighbour& near : search.Nearest(controllers.col(c), 1)) {
      if (near.distance < kCoincident) throw CoincidentController(where, c, near.index);
    }
  }
}

}  // namespace

std::vector<std::array<int, 2>> BuildSprings(const Points& position, int controllers,
                                             const Rod& rod, const TopologyOptions& options,
                                             const std::string& where) {
  const int nodes = static_cast<int>(position.cols()) - controllers;
  if (nodes < 1 || nodes + controllers < 2) {
    throw Error(
        fmt::format("{}: {} particle(s) and {} controller(s) give no spring; needed are two "
                    "particles, or one and a controller",
                    where, nodes, controllers));
  }
  Springs springs;
  const Points free = position.leftCols(nodes);
  if (rod.empty()) {
    const double widest = WidestSpacing(free, where);
    JoinNearest(free, free, 0, options.radius, options.min_neighbours, options.max_neighbours,
                &springs);
    JoinGroups(free, widest, where, &springs);
    const Points hands = position.rightCols(controllers);
    CheckControllers(free, hands, where);
    JoinNearest(free, hands, nodes, options.controller_radius, options.min_neighbours,
                options.controller_max_neighbours, &springs);
  } else {
    const Rod alone = RodOfNodes(rod, nodes);
    springs = SpringsAlong(alone, std::max(1, options.max_neighbours / 2), options.joint_reach);
    JoinGroups(free, LongestEdge(alone, free, where), where, &springs);
    JoinNearestOnRod(rod, position, nodes, options, where, &springs);
  }
  if (springs.empty()) {
    throw Error(
        fmt::format("{}: no controller is joined to the particle; the search radius for "
                    "controllers, {} m, is too small",
                    where, options.controller_radius));
  }
  return {springs.begin(), springs.end()};
}

std::vector<std::array<int, 2>> ChainSprings(const Rod& rod, int nodes) {
  const Springs springs = SpringsAlong(RodOfNodes(rod, nodes), 1, TopologyOptions::kBracedJoint);
  return {springs.begin(), springs.end()};
}

Eigen::VectorXd SpringLengths(const std::vector<std::array<int, 2>>& springs,
                              const Points& position, const Rod& rod) {
  Eigen::VectorXd length(springs.size());
  const RodLengths along(rod);
  for (std::size_t e = 0; e < springs.size(); ++e) {
    const auto [a, b] = springs[e];
    length[e] =
        rod.empty() ? (position.col(a) - position.col(b)).norm() : along.Between(a, b, position);
  }
  return length;
}

}  // namespace physpring
