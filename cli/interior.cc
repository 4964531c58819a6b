// SPDX-License-Identifier: Apache-2.0
// physpring interior: a recording and a mesh of its object -> the recording with particles inside.
#include "jobs/interior.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/warnings.h"

namespace physpring {
namespace {

struct InteriorArguments {
  std::string recording, output;
  InteriorOptions options;
  bool force = false;
};

void Run(const InteriorArguments& arguments) {
  ExpectOutputs({arguments.output}, {arguments.recording, arguments.options.mesh});
  ExpectNew(arguments.output, arguments.force);
  const auto [recording, on_surface, warnings] =
      FillInterior(ReadRecording(arguments.recording), arguments.recording, arguments.options);
  PrintWarnings(warnings);
  WriteRecording(recording, arguments.output);
  fmt::print("{}: {} points, {} interior{}, {} controllers\n", arguments.output,
             recording.point_count(), recording.interior_count(),
             arguments.options.surface ? fmt::format(" ({} on the surface)", on_surface) : "",
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
      ->add_option("--mesh", arguments->options.mesh,
                   "surface (OBJ, PLY, STL, GLB) on which the recording's points are in frame 0; "
                   "glTF is turned from y up to z up")
      ->required()
      ->type_name("FILE");
  command->add_option("--spacing", arguments->options.spacing, "of the particles inside")
      ->check(NumberBetween(1e-6, 10))
      ->type_name("METRES")
      ->capture_default_str();
  command->add_flag("--surface", arguments->options.surface,
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
