// SPDX-License-Identifier: Apache-2.0
// physpring interior: a recording and a mesh of its object -> the recording with particles inside.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "exporter/mesh_interior.h"
#include "exporter/mesh_place.h"
#include "exporter/mesh_samples.h"
#include "twin/checks/objects.h"
#include "twin/error.h"
#include "twin/neighbours.h"
#include "twin/recording.h"

namespace physpring {
namespace {

struct InteriorArguments {
  std::string recording, mesh, output;
  double spacing = 0.01;
  bool surface = false, force = false;
};

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

void Run(const InteriorArguments& arguments) {
  ExpectOutputs({arguments.output}, {arguments.recording, arguments.mesh});
  ExpectNew(arguments.output, arguments.force);
  Recording recording = ReadRecording(arguments.recording);
  ExpectPlain(recording, arguments.recording);
  const PlacedMesh placed =
      ReadMeshAt(arguments.mesh, recording.start.leftCols(recording.point_count()));
  for (const std::string& warning : placed.warnings) fmt::print(stderr, "warning: {}\n", warning);
  Points on_surface(3, 0);
  if (arguments.surface) on_surface = OnBareSurface(placed.mesh, recording);
  const Points inside =
      SampleInterior(placed.mesh, arguments.spacing, SideBySide(recording.start, on_surface));
  if (inside.cols() + on_surface.cols() == 0) {
    throw Error(
        fmt::format("{}: {}no point of a lattice of {} m is inside; a smaller --spacing {}is "
                    "needed",
                    arguments.mesh, arguments.surface ? "points cover its surface, and " : "",
                    arguments.spacing, arguments.surface ? "" : "or a closed mesh "));
  }
  AddInterior(SideBySide(on_surface, inside), &recording);
  WriteRecording(recording, arguments.output);
  fmt::print("{}: {} points, {} interior{}, {} controllers\n", arguments.output,
             recording.point_count(), recording.interior_count(),
             arguments.surface ? fmt::format(" ({} on the surface)", on_surface.cols()) : "",
             recording.controller_count());
}

}  // namespace

void AddInteriorCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "interior",
      "Fills a mesh of the object, as it is in frame 0 of a recording, with particles that no "
      "camera sees, and writes the recording with them.");
  const auto arguments = std::make_shared<InteriorArguments>();
  command->add_option("recording", arguments->recording, "recording")
      ->required()
      ->type_name("REC.npz");
  command
      ->add_option("--mesh", arguments->mesh,
                   "surface (OBJ, PLY, STL, GLB) on which the recording's points are in frame 0; "
                   "glTF is turned from y up to z up")
      ->required()
      ->type_name("FILE");
  command->add_option("--spacing", arguments->spacing, "of the particles inside")
      ->check(NumberBetween(1e-6, 10))
      ->type_name("METRES")
      ->capture_default_str();
  command->add_flag("--surface", arguments->surface,
                    "also on the surface where no point is, as on the side that a camera does not "
                    "see");
  command->add_option("-o,--output", arguments->output, "recording to write")
      ->required()
      ->check(FileNameWith(".npz"))
      ->type_name("NEW.npz");
  command->add_flag("--force", arguments->force, "overwrite a file");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
