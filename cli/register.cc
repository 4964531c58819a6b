// SPDX-License-Identifier: Apache-2.0
// physpring register: clouds of points without names -> a recording of points that are followed.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "jobs/registration.h"
#include "registration/placed_twin.h"

namespace physpring {
namespace {

struct RegisterArguments {
  std::string recording, like, shape, output;
  int points = 0, threads = AllCores();
  bool refine = false;
  bool markers = false, rod = false;
  bool force = false;
};

void RunMarkers(const RegisterArguments& arguments, const Recording& clouds) {
  const RegisteredMarkers registered = RegisterMarkers(clouds, arguments.rod);
  WriteRecording(registered.recording, arguments.output);
  fmt::print(
      "{}: {} markers, {:.1f} mm apart; {:.0f} % of them are found in a frame, {:.1f} mm from "
      "where they are expected\n",
      arguments.output, registered.recording.point_count(), 1e3 * registered.spacing,
      100 * registered.seen, 1e3 * registered.distance);
  PrintWarnings(WarningsOf(registered));
}

// Of a recording, or of a twin.
Recording ReadKnownPoints(const std::string& path) {
  return path.ends_with(".twin.npz") ? ReferenceOf(ReadTwin(path)) : ReadRecording(path);
}

CloudRegistration RegisterWithProgress(const Recording& clouds,
                                       const RegistrationOptions& options) {
  return UnlessStopped([&] {
    Progress progress(0);
    const CloudRegistration registration = RegisterAsAsked(
        clouds, options,
        [&](double share, const std::string& status) { progress.Show(share, status); });
    if (!registration.refined.empty()) progress.Say(registration.refined);
    return registration;
  });
}

void Run(const RegisterArguments& arguments) {
  ExpectOutputs({arguments.output}, {arguments.recording, arguments.like, arguments.shape});
  ExpectNew(arguments.output, arguments.force);
  const Recording clouds = ReadRecordingOrClouds(arguments.recording);
  ExpectClouds(clouds, arguments.recording);
  PrintRemarks({&clouds, 1});
  if (arguments.markers) return RunMarkers(arguments, clouds);
  RegistrationOptions options{.points = arguments.points, .shape = arguments.shape};
  options.refine = arguments.refine;
  options.threads = arguments.threads;
  if (!arguments.like.empty()) options.like = ReadKnownPoints(arguments.like);
  const CloudRegistration registration = RegisterWithProgress(clouds, options);
  const RegisteredClouds& registered = registration.clouds;
  WriteRecording(registered.recording, arguments.output);
  fmt::print("{}: {} points, {:.1f} mm apart; clouds tell of {:.0f} % of them in a frame\n",
             arguments.output, registered.recording.point_count(), 1e3 * registered.fit.spacing,
             100 * registered.seen);
  if (std::isfinite(registered.distance)) {
    fmt::print("clouds are {:.1f} mm from the nearest points, mean of all frames{}\n",
               1e3 * registered.distance,
               std::isfinite(registered.fit.distance)
                   ? fmt::format("; {:.1f} mm in the last second", 1e3 * registered.fit.distance)
                   : "");
  }
  PrintWarnings(registration.warnings);
}

}  // namespace

void AddRegisterCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "register",
      "Makes points that are followed of clouds whose points have no names, as depth cameras give "
      "them.");
  const auto arguments = std::make_shared<RegisterArguments>();
  command
      ->add_option("recording", arguments->recording,
                   "recording with `surface`, points without names")
      ->required()
      ->type_name("CLOUDS.npz");
  command->add_option("-o,--output", arguments->output, "recording to write")
      ->required()
      ->check(FileNameWith(".npz"))
      ->type_name("REC.npz");
  AddNumberOrAuto(command, "--points", &arguments->points,
                  "how many; auto: half as many again as a cloud has, 400 at most");
  command
      ->add_option("--like", arguments->like,
                   "take the points of this recording, or twin, of the same object")
      ->excludes("--points")
      ->type_name("REC.npz|TWIN.twin.npz");
  command
      ->add_option("--shape", arguments->shape,
                   "surface of the whole object as it is in frame 0 (OBJ, PLY, STL, GLB), of which "
                   "the clouds may show one side only; glTF is turned from y up to z up")
      ->excludes("--like")
      ->type_name("FILE");
  CLI::Option* refine = command->add_flag(
      "--refine", arguments->refine,
      "fit twins to the points, and name them anew where those predict them; some minutes");
  CLI::Option* threads =
      AddThreads(command, &arguments->threads, "at most; the result does not depend on it");
  CLI::Option* markers = command->add_flag(
      "--markers", arguments->markers,
      "the points are markers, the same ones in each frame in any order; some may be hidden");
  markers->excludes("--points")
      ->excludes("--like")
      ->excludes("--shape")
      ->excludes(refine)
      ->excludes(threads);
  command->add_flag("--rod", arguments->rod, "the markers are along a rod: write their `order`")
      ->needs(markers);
  command->add_flag("--force", arguments->force, "overwrite a file");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
