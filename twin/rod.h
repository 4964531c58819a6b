// SPDX-License-Identifier: Apache-2.0
// A rod, or several that are joined to a graph: a cable with branches, a harness. Its columns are
// nodes and controllers, as those of a body. An edge joins two that follow each other along it. A
// joint is a column with three edges or more. A controller without edges is no part of the rod: it
// only holds it.
#ifndef PHYSPRING_TWIN_ROD_H_
#define PHYSPRING_TWIN_ROD_H_

#include <array>
#include <vector>

#include "twin/points.h"

namespace physpring {

using RodEdges = std::vector<std::array<int, 2>>;

struct Rod {
  // Of each column, m. Between joints it is the arc length; one branch goes on after another one.
  Eigen::VectorXd arc;
  RodEdges edges;  // (a, b), a < b, sorted

  bool empty() const { return arc.size() == 0; }
  bool operator==(const Rod& other) const {
    return arc.size() == other.arc.size() && arc == other.arc && edges == other.edges;
  }
};

// Pairs of ends as edges. Throws Error, how it goes on after the name of the pairs, if one is no
// edge between two of so many columns, or if a column has more than 16.
RodEdges EdgesOfEnds(const std::vector<int>& ends, Eigen::Index columns);
// Edges of `columns`, each to the next by arc length.
RodEdges ChainEdges(const Eigen::VectorXd& arc, const std::vector<int>& columns);
// All columns one after the other by arc length (m, all different).
Rod PlainRod(const Eigen::VectorXd& arc);
// Whether it is one rod without joints, along which the arc length grows.
bool IsPlain(const Rod& rod);
// Of all branches together, m.
double RodLength(const Rod& rod);
int RodJoints(const Rod& rod);
// Those that have an edge.
std::vector<int> ColumnsOnRod(const Rod& rod);

// A rod with these edges, which is as long between columns as they are apart in `position` (m).
// Columns without edges get the arc length of the nearest one that has some.
Rod RodOfEdges(RodEdges edges, const Points& position);

// Those next to each column, by arc length.
std::vector<std::vector<int>> RodNeighbours(const Rod& rod);
// The ways from each end or joint to the next one, and loops: columns one after the other.
std::vector<std::vector<int>> RodWays(const Rod& rod);
// The number of the part that each column is joined to by edges; -1: it has none.
std::vector<int> RodParts(const Rod& rod);
// Takes a column out of the rod; those next to it are then next to each other.
void TakeOut(int column, Rod* rod);
// That of the nodes, which are the first columns, without the controllers.
Rod RodOfNodes(Rod rod, int nodes);
// The rod of `columns` alone, in this order. Others are not taken out first.
Rod PartOfRod(const Rod& rod, const std::vector<int>& columns);

// Distances along a rod.
class RodLengths {
 public:
  explicit RodLengths(const Rod& rod);
  // Whether two columns are on a way without joints, so that their arc lengths tell how far apart
  // they are.
  bool Along(int a, int b) const { return stretch_[a] >= 0 && stretch_[a] == stretch_[b]; }
  // m; in `position` where a joint lies between.
  double Between(int a, int b, const Points& position) const;

 private:
  const Eigen::VectorXd arc_;
  std::vector<int> stretch_;  // of a column: the number of its stretch; -1: a joint, or in a loop
};

// The rod of a coarser body. `node_of`: its node for each of the finer one's nodes; controllers are
// the same. Arc lengths are means of the members'. A plain rod stays one.
Rod CoarseRod(const Rod& fine, const std::vector<int>& node_of, int nodes);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_ROD_H_
