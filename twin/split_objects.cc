// SPDX-License-Identifier: Apache-2.0
#include "twin/split_objects.h"

#include <fmt/format.h>

#include <cmath>

#include "twin/checks/objects.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

using Columns = std::vector<Eigen::Index>;

// Those of [first, first + count) that belong to the object, less `first`.
Columns ColumnsOf(const Recording& recording, int object, Eigen::Index first, Eigen::Index count) {
  Columns columns;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (recording.object[first + i] == object) columns.push_back(i);
  }
  return columns;
}

template <class Frames>
void Keep(const Columns& columns, Frames* frames) {
  for (auto& frame : *frames) frame = frame(Eigen::all, columns).eval();
}

// The column of `points` that is nearest to a place, of those that are seen; -1: none is.
Eigen::Index NearestSeen(const Points& points, const Eigen::Vector3d& place) {
  Eigen::Index nearest = -1;
  double least = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double distance = (points.col(i) - place).squaredNorm();
    if (!std::isfinite(distance) || (nearest >= 0 && distance >= least)) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

// The clouds with the points of other objects as NaN.
std::vector<Points> CloudsOf(const Recording& recording, int object) {
  std::vector<Points> clouds = recording.surface;
  for (std::size_t t = 0; t < clouds.size(); ++t) {
    for (Eigen::Index i = 0; i < clouds[t].cols(); ++i) {
      const Eigen::Index nearest = NearestSeen(recording.points[t], clouds[t].col(i));
      if (nearest >= 0 && recording.object[nearest] != object) {
        clouds[t].col(i).setConstant(std::nan(""));
      }
    }
  }
  return clouds;
}

// The key points that are nearest to a particle of the object where they are first seen.
Columns KeyPointsOf(const Recording& recording, int object) {
  Columns columns;
  const Points start = recording.start.leftCols(recording.particle_count());
  for (Eigen::Index i = 0; !recording.track.empty() && i < recording.track[0].cols(); ++i) {
    const Eigen::Index nearest = NearestSeen(start, recording.track[0].col(i));
    if (nearest >= 0 && recording.object[nearest] == object) columns.push_back(i);
  }
  return columns;
}

Recording PartOf(const Recording& recording, int object) {
  const Eigen::Index points = recording.point_count(), particles = recording.particle_count();
  const Columns seen = ColumnsOf(recording, object, 0, points);
  const Columns inside = ColumnsOf(recording, object, points, recording.interior_count());
  const Columns hands = ColumnsOf(recording, object, particles, recording.controller_count());
  Columns own = ColumnsOf(recording, object, 0, particles), all = own;
  for (Eigen::Index hand : hands) all.push_back(particles + hand);

  Recording part = recording;
  part.name = fmt::format("{}_object{}", recording.name, object);
  part.hash.clear();
  part.object.resize(0);
  part.mass *= static_cast<double>(own.size()) / static_cast<double>(particles);
  Keep(seen, &part.points);
  Keep(seen, &part.weight);
  Keep(hands, &part.controllers);
  Keep(hands, &part.force);
  if (part.held.size() > 0) part.held = recording.held(Eigen::all, hands);
  part.shape_when_held.clear();
  for (const auto& [frame, shape] : recording.shape_when_held) {
    part.shape_when_held[frame] = shape(Eigen::all, own);
  }
  part.interior = recording.interior(Eigen::all, inside);
  part.start = recording.start(Eigen::all, all);
  part.rest = recording.rest(Eigen::all, all);
  part.velocity = recording.velocity(Eigen::all, own);
  part.rod = PartOfRod(recording.rod, {all.begin(), all.end()});
  part.surface = CloudsOf(recording, object);
  const Columns keys = KeyPointsOf(recording, object);
  if (keys.empty()) {
    part.track.clear();
  } else {
    Keep(keys, &part.track);
  }
  return part;
}

}  // namespace

std::vector<Recording> SplitObjects(const Recording& recording) {
  if (recording.object.size() == 0) return {recording};
  std::vector<Recording> parts;
  for (int object = 0; object < ObjectCount(recording); ++object) {
    parts.push_back(PartOf(recording, object));
  }
  return parts;
}

}  // namespace physpring
