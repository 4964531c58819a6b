// SPDX-License-Identifier: Apache-2.0
#include "twin/neighbours.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <utility>

#include "twin/point_cloud.h"

namespace physpring {
namespace {

// What nanoflann asks of a result set; its own one has another type in each of its versions.
struct WithinRadius {
  double radius_squared;
  std::vector<Neighbour>* found;
  std::size_t size() const { return found->size(); }
  bool full() const { return true; }
  double worstDist() const { return radius_squared; }
  bool addPoint(double distance_squared, int index) const {
    if (distance_squared < radius_squared) found->push_back({index, std::sqrt(distance_squared)});
    return true;
  }
};

// Nearest first; equally near ones by index.
void Sort(std::vector<Neighbour>* neighbours) {
  std::sort(neighbours->begin(), neighbours->end(), [](const Neighbour& a, const Neighbour& b) {
    return std::pair(a.distance, a.index) < std::pair(b.distance, b.index);
  });
}

}  // namespace

struct NeighbourSearch::Tree {
  using Index =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>,
                                          PointCloud, 3, int>;

  Points points;
  PointCloud cloud{points};
  Index index;
  explicit Tree(const Points& copied)
      : points(copied), index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    index.buildIndex();
  }
};

NeighbourSearch::NeighbourSearch(const Points& points) : tree_(std::make_unique<Tree>(points)) {}
NeighbourSearch::~NeighbourSearch() = default;

std::vector<Neighbour> NeighbourSearch::Nearest(const Eigen::Vector3d& query, int count) const {
  count = std::min(count, static_cast<int>(tree_->points.cols()));
  if (count <= 0) return {};
  std::vector<int> index(count);
  std::vector<double> squared(count);
  tree_->index.knnSearch(query.data(), static_cast<std::size_t>(count), index.data(),
                         squared.data());
  // take all that are as far as the farthest, so that ties do not depend on the tree
  const double reach = std::sqrt(squared.back());
  std::vector<Neighbour> found = Within(query, reach * (1 + 1e-9) + 1e-12);
  found.resize(std::min(found.size(), static_cast<std::size_t>(count)));
  return found;
}

std::vector<Neighbour> NeighbourSearch::Within(const Eigen::Vector3d& query, double radius) const {
  std::vector<Neighbour> found;
  WithinRadius result{radius * radius, &found};
  tree_->index.radiusSearchCustomCallback(query.data(), result);
  Sort(&found);
  return found;
}

double MedianSpacing(const Points& points) {
  const NeighbourSearch search(points);
  std::vector<double> spacing;
  for (int i = 0; i < points.cols(); ++i) {
    spacing.push_back(search.Nearest(points.col(i), 2)[1].distance);
  }
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  return *middle;
}

std::vector<std::array<int, 2>> PairsWithin(const Points& points, double radius) {
  std::vector<std::array<int, 2>> pairs;
  if (points.cols() == 0) return pairs;
  const NeighbourSearch search(points);
  for (int i = 0; i < points.cols(); ++i) {
    for (const Neighbour& neighbour : search.Within(points.col(i), radius)) {
      if (neighbour.index > i) pairs.push_back({i, neighbour.index});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace physpring
