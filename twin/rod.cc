// SPDX-License-Identifier: Apache-2.0
#include "twin/rod.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "twin/error.h"

namespace physpring {
namespace {

constexpr std::size_t kMostEdges = 16;  // of a joint: each two of them are a bend

using Neighbours = std::vector<std::vector<int>>;

Neighbours NeighboursOf(const RodEdges& edges, Eigen::Index columns) {
  Neighbours neighbours(static_cast<std::size_t>(columns));
  for (const auto& [a, b] : edges) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  return neighbours;
}

std::vector<int> AllColumns(Eigen::Index count) {
  std::vector<int> columns(static_cast<std::size_t>(count));
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

void SortEdges(RodEdges* edges) {
  for (auto& [a, b] : *edges) {
    if (a > b) std::swap(a, b);
  }
  std::sort(edges->begin(), edges->end());
  edges->erase(std::unique(edges->begin(), edges->end()), edges->end());
}

// Walks over all columns that `start` is joined to, along one branch after the other. Calls
// visit(column, the one before or -1).
template <class Visit>
void Walk(const Neighbours& neighbours, int start, std::vector<bool>* seen, const Visit& visit) {
  std::vector<std::pair<int, int>> next = {{start, -1}};
  while (!next.empty()) {
    const auto [column, before] = next.back();
    next.pop_back();
    if ((*seen)[column]) continue;
    (*seen)[column] = true;
    visit(column, before);
    for (auto i = neighbours[column].rbegin(); i != neighbours[column].rend(); ++i) {
      if (!(*seen)[*i]) next.emplace_back(*i, column);
    }
  }
}

}  // namespace

RodEdges EdgesOfEnds(const std::vector<int>& ends, Eigen::Index columns) {
  if (ends.size() % 2 != 0) throw Error("has an odd number of ends, expected pairs");
  RodEdges edges;
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const int a = ends[i], b = ends[i + 1];
    if (std::min(a, b) < 0 || std::max(a, b) >= columns || a == b) {
      throw Error(fmt::format("has an edge from {} to {}, expected two numbers of 0 to {}", a, b,
                              columns - 1));
    }
    edges.push_back({a, b});
  }
  SortEdges(&edges);
  const Neighbours neighbours = NeighboursOf(edges, columns);
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (neighbours[i].size() <= kMostEdges) continue;
    throw Error(fmt::format("has {} edges of {}, expected at most {}", neighbours[i].size(), i,
                            kMostEdges));
  }
  return edges;
}

RodEdges ChainEdges(const Eigen::VectorXd& arc, const std::vector<int>& columns) {
  std::vector<int> sorted = columns;
  std::stable_sort(sorted.begin(), sorted.end(), [&](int i, int j) { return arc[i] < arc[j]; });
  RodEdges edges;
  for (std::size_t i = 1; i < sorted.size(); ++i) edges.push_back({sorted[i - 1], sorted[i]});
  SortEdges(&edges);
  return edges;
}

Rod PlainRod(const Eigen::VectorXd& arc) { return {arc, ChainEdges(arc, AllColumns(arc.size()))}; }

std::vector<int> ColumnsOnRod(const Rod& rod) {
  std::vector<int> columns;
  const Neighbours neighbours = NeighboursOf(rod.edges, rod.arc.size());
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (!neighbours[i].empty()) columns.push_back(static_cast<int>(i));
  }
  return columns;
}

double RodLength(const Rod& rod) {
  return rod.empty() ? 0 : rod.arc.maxCoeff() - rod.arc.minCoeff();
}

int RodJoints(const Rod& rod) {
  const Neighbours neighbours = NeighboursOf(rod.edges, rod.arc.size());
  return static_cast<int>(std::count_if(neighbours.begin(), neighbours.end(),
                                        [](const auto& own) { return own.size() > 2; }));
}

bool IsPlain(const Rod& rod) {
  return !rod.empty() && rod.edges == ChainEdges(rod.arc, ColumnsOnRod(rod));
}

Rod RodOfEdges(RodEdges edges, const Points& position) {
  SortEdges(&edges);
  const Neighbours neighbours = NeighboursOf(edges, position.cols());
  const int count = static_cast<int>(neighbours.size());
  Rod rod = {Eigen::VectorXd::Zero(count), std::move(edges)};
  double reached = 0;
  std::vector<bool> seen(neighbours.size());
  const auto walk = [&](int start) {
    Walk(neighbours, start, &seen, [&](int column, int before) {
      if (before >= 0) reached += (position.col(column) - position.col(before)).norm();
      rod.arc[column] = reached;
    });
  };
  // from ends, so that a rod without joints is gone along in one way; then what is left, loops
  for (const bool ends : {true, false}) {
    for (int i = 0; i < count; ++i) {
      const std::size_t degree = neighbours[i].size();
      if (!seen[i] && degree > 0 && (!ends || degree == 1)) walk(i);
    }
  }
  const std::vector<int> on_rod = ColumnsOnRod(rod);
  for (int i = 0; i < count && !on_rod.empty(); ++i) {
    if (!neighbours[i].empty()) continue;
    const auto nearer = [&](int a, int b) {
      return (position.col(a) - position.col(i)).norm() <
             (position.col(b) - position.col(i)).norm();
    };
    rod.arc[i] = rod.arc[*std::min_element(on_rod.begin(), on_rod.end(), nearer)];
  }
  return rod;
}

std::vector<std::vector<int>> RodNeighbours(const Rod& rod) {
  Neighbours neighbours = NeighboursOf(rod.edges, rod.arc.size());
  for (std::vector<int>& own : neighbours) {
    std::sort(own.begin(), own.end(),
              [&](int i, int j) { return std::pair(rod.arc[i], i) < std::pair(rod.arc[j], j); });
  }
  return neighbours;
}

std::vector<std::vector<int>> RodWays(const Rod& rod) {
  const Neighbours neighbours = RodNeighbours(rod);
  std::vector<int> sorted = ColumnsOnRod(rod);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int i, int j) { return rod.arc[i] < rod.arc[j]; });
  std::set<std::array<int, 2>> gone;
  const auto go = [&](int a, int b) {
    return gone.insert({std::min(a, b), std::max(a, b)}).second;
  };
  std::vector<std::vector<int>> ways;
  for (const bool loops : {false, true}) {
    for (const int start : sorted) {
      if (!loops && neighbours[start].size() == 2) continue;
      for (int next : neighbours[start]) {
        if (!go(start, next)) continue;
        std::vector<int> way = {start, next};
        while (neighbours[next].size() == 2) {
          const int before = way[way.size() - 2];
          const int after = neighbours[next][neighbours[next][0] == before ? 1 : 0];
          if (!go(next, after)) break;
          way.push_back(next = after);
        }
        ways.push_back(way);
      }
    }
  }
  return ways;
}

std::vector<int> RodParts(const Rod& rod) {
  const Neighbours neighbours = NeighboursOf(rod.edges, rod.arc.size());
  std::vector<int> part(neighbours.size(), -1);
  std::vector<bool> seen(neighbours.size());
  int parts = 0;
  for (int i = 0; i < std::ssize(neighbours); ++i) {
    if (seen[i] || neighbours[i].empty()) continue;
    Walk(neighbours, i, &seen, [&](int column, int) { part[column] = parts; });
    ++parts;
  }
  return part;
}

void TakeOut(int column, Rod* rod) {
  const std::vector<int> next = NeighboursOf(rod->edges, rod->arc.size())[column];
  std::erase_if(rod->edges,
                [&](const auto& edge) { return edge[0] == column || edge[1] == column; });
  for (std::size_t i = 0; i < next.size(); ++i) {
    for (std::size_t j = i + 1; j < next.size(); ++j) rod->edges.push_back({next[i], next[j]});
  }
  SortEdges(&rod->edges);
}

Rod PartOfRod(const Rod& rod, const std::vector<int>& columns) {
  if (rod.empty()) return {};
  std::vector<int> place(static_cast<std::size_t>(rod.arc.size()), -1);
  for (std::size_t i = 0; i < columns.size(); ++i) place[columns[i]] = static_cast<int>(i);
  Rod part = {rod.arc(columns), {}};
  for (const auto& [a, b] : rod.edges) {
    if (place[a] >= 0 && place[b] >= 0) part.edges.push_back({place[a], place[b]});
  }
  SortEdges(&part.edges);
  return part;
}

Rod RodOfNodes(Rod rod, int nodes) {
  for (int column = nodes; column < rod.arc.size(); ++column) TakeOut(column, &rod);
  rod.arc.conservativeResize(std::min<Eigen::Index>(nodes, rod.arc.size()));
  return rod;
}

RodLengths::RodLengths(const Rod& rod)
    : arc_(rod.arc), stretch_(static_cast<std::size_t>(rod.arc.size()), -1) {
  const Neighbours all = NeighboursOf(rod.edges, rod.arc.size());
  const int columns = static_cast<int>(all.size());
  // a loop's arc lengths have a jump somewhere
  std::vector<bool> in_loop(all.size()), seen(all.size());
  for (int i = 0; i < columns; ++i) {
    if (seen[i]) continue;
    std::vector<int> part;
    std::size_t ends = 0;
    Walk(all, i, &seen, [&](int column, int) {
      part.push_back(column);
      ends += all[column].size();
    });
    if (ends / 2 < part.size()) continue;
    for (int column : part) in_loop[column] = true;
  }
  Neighbours without_joints = all;
  for (int i = 0; i < columns; ++i) {
    if (all[i].size() > 2) without_joints[i].clear();
    std::erase_if(without_joints[i], [&](int j) { return all[j].size() > 2; });
  }
  seen.assign(all.size(), false);
  int stretches = 0;
  for (int i = 0; i < columns; ++i) {
    if (seen[i] || in_loop[i] || all[i].empty() || all[i].size() > 2) continue;
    Walk(without_joints, i, &seen, [&](int column, int) { stretch_[column] = stretches; });
    ++stretches;
  }
}

double RodLengths::Between(int a, int b, const Points& position) const {
  return Along(a, b) ? std::abs(arc_[a] - arc_[b]) : (position.col(a) - position.col(b)).norm();
}

Rod CoarseRod(const Rod& fine, const std::vector<int>& node_of, int nodes) {
  if (fine.empty()) return {};
  const int particles = static_cast<int>(node_of.size());
  const int controllers = static_cast<int>(fine.arc.size()) - particles;
  Rod coarse = {Eigen::VectorXd::Zero(nodes + controllers), {}};
  coarse.arc.tail(controllers) = fine.arc.tail(controllers);
  Eigen::VectorXd members = Eigen::VectorXd::Zero(nodes);
  for (int i = 0; i < particles; ++i) {
    coarse.arc[node_of[i]] += fine.arc[i];
    members[node_of[i]] += 1;
  }
  coarse.arc.head(nodes).array() /= members.array();
  const auto column_of = [&](int i) { return i < particles ? node_of[i] : i - particles + nodes; };
  for (const auto& [a, b] : fine.edges) {
    if (column_of(a) != column_of(b)) coarse.edges.push_back({column_of(a), column_of(b)});
  }
  SortEdges(&coarse.edges);
  // members of a plain rod's nodes may lie between each other
  if (IsPlain(fine)) coarse.edges = ChainEdges(coarse.arc, ColumnsOnRod(coarse));
  return coarse;
}

}  // namespace physpring
