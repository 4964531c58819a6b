// SPDX-License-Identifier: Apache-2.0
// Which nodes are joined by springs.
//
// Free nodes: PhysTwin's hybrid search (the nearest max_neighbours within a radius), which with an
// infinite radius is k nearest neighbours; for rods, the next ones along it. Controllers are joined
// to their nearest free nodes in the same way, never to each other. Where the radius holds fewer
// than min_neighbours, that many nearest are taken.
#ifndef PHYSPRING_TWIN_TOPOLOGY_H_
#define PHYSPRING_TWIN_TOPOLOGY_H_

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "twin/points.h"
#include "twin/rod.h"

namespace physpring {

struct TopologyOptions {
  double radius = std::numeric_limits<double>::infinity();  // m
  int max_neighbours = 12;                                  // a node's, itself not counted
  double controller_radius = std::numeric_limits<double>::infinity();  // m
  int controller_max_neighbours = 12;                                  // a controller's
  int min_neighbours = 0;  // a node's or a controller's, however far they are
  // Of a rod with branches: so many next to a joint on each way are joined to those on the others,
  // so that it keeps its shape. 0: nothing but bending holds it.
  int joint_reach = kBracedJoint;

  static constexpr int kBracedJoint = 2;
};

// Springs (a, b), a < b, sorted. `position` (3 x (nodes + controllers), m, finite) holds the
// controllers last. Along a `rod` (may be empty) a node's neighbours are the max_neighbours / 2
// next ones on each way from it, and distances are taken along it (RodLengths). Groups of nodes
// that the search leaves apart are joined where they are nearest. Throws Error, beginning with
// `where`, if there is nothing to join, if two nodes or a controller and a node coincide, or if two
// groups are so far apart that they cannot be one object (more than 5 times the greatest distance
// of a node to its nearest neighbour).
std::vector<std::array<int, 2>> BuildSprings(const Points& position, int controllers,
                                             const Rod& rod, const TopologyOptions& options,
                                             const std::string& where);

// The springs between nodes of a chain, with braced joints: those that BuildSprings gives with two
// neighbours.
std::vector<std::array<int, 2>> ChainSprings(const Rod& rod, int nodes);

// Distances (springs), m, in `position`, or along the rod if there is one.
Eigen::VectorXd SpringLengths(const std::vector<std::array<int, 2>>& springs,
                              const Points& position, const Rod& rod);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_TOPOLOGY_H_
