// SPDX-License-Identifier: Apache-2.0
#include "twin/unseen_points.h"

#include <algorithm>
#include <limits>

#include "twin/rotation.h"

namespace physpring {
namespace {

constexpr std::size_t kNeighbours = 8;

bool IsKnown(const Points& points, Eigen::Index i) { return points.col(i).allFinite(); }

// All columns (points, interior, controllers) in `frame`; interior particles are not seen there.
Points ShapeInFrame(const Recording& recording, std::size_t frame) {
  Points shape =
      Points::Constant(3, recording.start.cols(), std::numeric_limits<double>::quiet_NaN());
  shape.leftCols(recording.point_count()) = recording.points[frame];
  shape.rightCols(recording.controller_count()) = recording.controllers[frame];
  return shape;
}

// The columns nearest to column i of `shape` that are known in `shape` and in `start`.
std::vector<Eigen::Index> NearestKnown(const Points& shape, const Points& start, Eigen::Index i) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index j = 0; j < start.cols(); ++j) {
    if (IsKnown(shape, j) && IsKnown(start, j)) known.push_back(j);
  }
  const auto distance_squared = [&](Eigen::Index j) {
    return (shape.col(j) - shape.col(i)).squaredNorm();
  };
  const auto count = static_cast<std::ptrdiff_t>(std::min(kNeighbours, known.size()));
  std::partial_sort(
      known.begin(), known.begin() + count, known.end(),
      [&](Eigen::Index a, Eigen::Index b) { return distance_squared(a) < distance_squared(b); });
  known.resize(static_cast<std::size_t>(count));
  return known;
}

Eigen::Vector3d MoveWithNeighbours(const Points& shape, const Points& start, Eigen::Index i) {
  const std::vector<Eigen::Index> neighbours = NearestKnown(shape, start, i);
  if (neighbours.empty()) return shape.col(i);
  return MoveRigidly(shape(Eigen::all, neighbours), start(Eigen::all, neighbours), shape.col(i));
}

std::size_t FirstFrameThatSees(const Recording& recording, Eigen::Index point) {
  std::size_t frame = 0;
  while (!IsKnown(recording.points.at(frame), point)) ++frame;
  return frame;
}

}  // namespace

std::vector<int> PlaceUnseenPoints(Recording& recording) {
  const Points known = recording.start;  // placed points are no neighbours of the next ones
  std::vector<int> placed;
  for (int i = 0; i < recording.point_count(); ++i) {
    if (IsKnown(known, i)) continue;
    const Points shape = recording.rest_given
                             ? recording.rest
                             : ShapeInFrame(recording, FirstFrameThatSees(recording, i));
    recording.start.col(i) = MoveWithNeighbours(shape, known, i);
    placed.push_back(i);
  }
  return placed;
}

}  // namespace physpring
