// SPDX-License-Identifier: Apache-2.0
#include "jobs/interior.h"

#include <fmt/format.h>

#include <utility>

#include "exporter/mesh_interior.h"
#include "exporter/mesh_place.h"
#include "exporter/mesh_samples.h"
#include "twin/checks/objects.h"
#include "twin/error.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

// Nobody knows the rest positions or arc lengths of new particles.
void ExpectPlain(const Recording& recording, const std::string& path) {
  if (recording.object.size() > 0) {
    throw Error(
        fmt::format("{}: shows {} objects, but a mesh is of one; `physpring split` makes a "
                    "recording of each",
                    path, ObjectCount(recording)));
  }
  const char* array = recording.interior_count() > 0 ? "interior"
                      : recording.rest_given         ? "rest"
                      : !recording.rod.empty()       ? "order' or 'rod"
                                                     : nullptr;
  if (!array) return;
  throw Error(
      fmt::format("{}: has an array '{}'; particles can only be added without one", path, array));
}

// The particles start at rest.
void AddInterior(const Points& interior, Recording* recording) {
  const int points = recording->point_count(), added = static_cast<int>(interior.cols());
  Points start(3, points + added + recording->controller_count());
  start << recording->start.leftCols(points), interior,
      recording->start.rightCols(recording->controller_count());
  Points velocity = Points::Zero(3, points + added);
  velocity.leftCols(points) = recording->velocity;
  recording->interior = interior;
  recording->start = start;
  recording->rest = start;
  recording->velocity = velocity;
}

// As far apart as the points are.
Points OnBareSurface(const TriangleMesh& mesh, const Recording& recording) {
  const Points points = recording.start.leftCols(recording.point_count());
  if (points.cols() < 2) throw Error("recording " + recording.name + ": has one point only");
  return SampleBare(mesh, MedianSpacing(points), recording.start);
}

Points SideBySide(const Points& some, const Points& others) {
  Points all(3, some.cols() + others.cols());
  all << some, others;
  return all;
}

}  // namespace

FilledRecording FillInterior(Recording recording, const std::string& path,
                             const InteriorOptions& options) {
  ExpectPlain(recording, path);
  PlacedMesh placed = ReadMeshAt(options.mesh, recording.start.leftCols(recording.point_count()));
  Points on_surface(3, 0);
  if (options.surface) on_surface = OnBareSurface(placed.mesh, recording);
  const Points inside =
      SampleInterior(placed.mesh, options.spacing, SideBySide(recording.start, on_surface));
  if (inside.cols() + on_surface.cols() == 0) {
    throw Error(
        fmt::format("{}: {}no point of a lattice of {} m is inside; a smaller --spacing {}is "
                    "needed",
                    options.mesh, options.surface ? "points cover its surface, and " : "",
                    options.spacing, options.surface ? "" : "or a closed mesh "));
  }
  AddInterior(SideBySide(on_surface, inside), &recording);
  return {std::move(recording), static_cast<int>(on_surface.cols()), std::move(placed.warnings)};
}

}  // namespace physpring
