// SPDX-License-Identifier: Apache-2.0
// physpring register: clouds of points without names -> a recording of points that are followed.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/warnings.h"
#include "registration/register_clouds.h"
#include "registration/register_markers.h"
#include "twin/error.h"

namespace physpring {
namespace {

struct RegisterArguments {
  std::string recording, like, output;
  int points = 0;
  bool markers = false, rod = false;
  bool force = false;
};

void WarnOfDoubts(const RegisteredClouds& registered) {
  if (registered.lost) {
    PrintWarnings({"it is lost: in the end the clouds are not where the points are"});
  }
  if (registered.outliers > 0) {
    PrintWarnings(
        {fmt::format("{} points of the first cloud are far from all others, and were left out",
                     registered.outliers)});
  }
}

RegisteredClouds Register(const RegisterArguments& arguments, const Recording& clouds) {
  if (arguments.markers) return RegisterMarkers(clouds, arguments.rod);
  if (arguments.like.empty()) return RegisterClouds(clouds, arguments.points);
  return RegisterCloudsLike(clouds, ReadRecording(arguments.like));
}

void Run(const RegisterArguments& arguments) {
  ExpectOutputs({arguments.output}, {arguments.recording, arguments.like});
  ExpectNew(arguments.output, arguments.force);
  const Recording clouds = ReadRecordingOrClouds(arguments.recording);
  if (clouds.point_count() > 0) {
    throw Error(arguments.recording +
                ": has 'points' already; without them, points are made of its clouds");
  }
  PrintRemarks({&clouds, 1});
  const RegisteredClouds registered = Register(arguments, clouds);
  WriteRecording(registered.recording, arguments.output);
  fmt::print("{}: {} points, {:.1f} mm apart; clouds tell of {:.0f} % of them in a frame\n",
             arguments.output, registered.recording.point_count(), 1e3 * registered.fit.spacing,
             100 * registered.seen);
  fmt::print("clouds are {:.1f} mm from the nearest points, mean of the last second\n",
             1e3 * registered.fit.distance);
  WarnOfDoubts(registered);
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
                   "take the points of this recording of the same object")
      ->excludes("--points")
      ->type_name("REC.npz");
  CLI::Option* markers = command->add_flag(
      "--markers", arguments->markers,
      "the points are markers, the same ones in each frame in any order; some may be hidden");
  markers->excludes("--points")->excludes("--like");
  command->add_flag("--rod", arguments->rod, "the markers are along a rod: write their `order`")
      ->needs(markers);
  command->add_flag("--force", arguments->force, "overwrite a file");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
