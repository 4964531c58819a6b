// SPDX-License-Identifier: Apache-2.0
// Neighbour searches in a set of points (nanoflann's k-d tree). Ties are broken by index, so the
// results are a function of the positions only.
#ifndef PHYSPRING_TWIN_NEIGHBOURS_H_
#define PHYSPRING_TWIN_NEIGHBOURS_H_

#include <array>
#include <memory>
#include <vector>

#include "twin/points.h"

namespace physpring {

struct Neighbour {
  int index;
  double distance;  // m
};

class NeighbourSearch {
 public:
  explicit NeighbourSearch(const Points& points);  // 3 x points, m; finite
  ~NeighbourSearch();

  // The `count` nearest points (fewer if there are no more), nearest first.
  std::vector<Neighbour> Nearest(const Eigen::Vector3d& query, int count) const;

  // All points nearer than `radius`, nearest first.
  std::vector<Neighbour> Within(const Eigen::Vector3d& query, double radius) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// Median distance of a point to its nearest other one, m. At least two points.
double MedianSpacing(const Points& points);

// All pairs (i < j) of points nearer to each other than `radius`, sorted.
std::vector<std::array<int, 2>> PairsWithin(const Points& points, double radius);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NEIGHBOURS_H_
