// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/objects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "twin/checks/motion_scale.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr int kJoinedNeighbours = 10;
// A pair belongs together if the distance between its points changes, over time, by less than so
// many spacings and so many deviations of the noise. A few frames at either end do not count.
constexpr double kChangeInSpacings = 1, kChangeInNoise = 5, kLeftOut = 0.05;
constexpr int kFewestOfObject = 3;
constexpr double kSmallestPart = 0.05;  // of the points

// By how much the distance between two points changes, m.
double ChangeOfDistance(const Recording& recording, int i, int j) {
  std::vector<double> distances;
  for (const Points& frame : recording.points) {
    const double distance = (frame.col(i) - frame.col(j)).norm();
    if (std::isfinite(distance)) distances.push_back(distance);
  }
  return Quantile(1 - kLeftOut, distances) - Quantile(kLeftOut, distances);
}

// The smallest index of the points that each point hangs together with.
class Groups {
 public:
  explicit Groups(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int Of(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(int i, int j) {
    const auto [first, second] = std::minmax({Of(i), Of(j)});
    parent_[second] = first;
  }

 private:
  std::vector<int> parent_;
};

Groups GroupPoints(const Recording& recording, const Points& points) {
  const double most = kChangeInSpacings * MedianSpacing(points) +
                      kChangeInNoise * MeasurementNoise(recording.points);
  const NeighbourSearch search(points);
  const int count = static_cast<int>(points.cols());
  Groups groups(count);
  for (int i = 0; i < count; ++i) {
    for (const Neighbour& near : search.Nearest(points.col(i), kJoinedNeighbours + 1)) {
      const int j = near.index;
      if (groups.Of(i) == groups.Of(j)) continue;
      if (ChangeOfDistance(recording, i, j) < most) groups.Join(i, j);
    }
  }
  return groups;
}

}  // namespace

Eigen::VectorXi FindObjects(const Recording& recording) {
  const int count = recording.point_count();
  if (count < 2 * kFewestOfObject) return {};
  const Points points = recording.start.leftCols(count);
  Groups groups = GroupPoints(recording, points);

  std::vector<int> size(count, 0), number(count, -1);
  for (int i = 0; i < count; ++i) ++size[groups.Of(i)];
  const double fewest = std::max<double>(kFewestOfObject, kSmallestPart * count);
  int objects = 0;
  for (int i = 0; i < count; ++i) {
    if (size[i] >= fewest) number[i] = objects++;  // only a group's first point has a size
  }
  if (objects < 2) return {};

  std::vector<int> members;
  for (int i = 0; i < count; ++i) {
    if (number[groups.Of(i)] >= 0) members.push_back(i);
  }
  const NeighbourSearch of_members(points(Eigen::all, members));
  Eigen::VectorXi object(recording.start.cols());
  for (Eigen::Index i = 0; i < object.size(); ++i) {
    const int nearest = members[of_members.Nearest(recording.start.col(i), 1)[0].index];
    object[i] = number[groups.Of(nearest)];
  }
  return object;
}

Eigen::VectorXi DeclaredObjects(const Recording& recording, const Eigen::VectorXi& declared) {
  std::map<int, int> numbers;
  const Eigen::Index particles = declared.size();
  const NeighbourSearch search(Points(recording.start.leftCols(particles)));
  Eigen::VectorXi object(recording.start.cols());
  for (Eigen::Index i = 0; i < object.size(); ++i) {
    const auto particle = i < particles ? i : search.Nearest(recording.start.col(i), 1)[0].index;
    const int next = static_cast<int>(numbers.size());
    object[i] = numbers.emplace(declared[particle], next).first->second;
  }
  return numbers.size() > 1 ? object : Eigen::VectorXi();
}

int ObjectCount(const Recording& recording) {
  return recording.object.size() > 0 ? recording.object.maxCoeff() + 1 : 1;
}

}  // namespace physpring
