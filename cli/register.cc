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

void WarnOfDoubts(const RegisteredMarkers& registered) {
  constexpr double kConfused = 0.05, kOthers = 0.5;
  std::vector<std::string> warnings;
  if (registered.lost_from) {
    warnings.push_back(
        fmt::format("they are lost: from frame {} on hardly any marker is found; do they move "
                    "further than {:.0f} "
                    "mm in a frame, or are all hidden for a while?",
                    *registered.lost_from, 500 * registered.spacing));
  } else if (registered.confused > kConfused) {
    warnings.push_back(fmt::format(
        "{:.0f} % of the markers are not found in frames that have points without a name instead: "
        "names may be wrong",
        100 * registered.confused));
  }
  if (registered.without_name > kOthers) {
    warnings.push_back(
        fmt::format("{:.2g} points of a frame, on the average, are no marker that is followed",
                    registered.without_name));
  }
  PrintWarnings(warnings);
}

void RunMarkers(const RegisterArguments& arguments, const Recording& clouds) {
  const RegisteredMarkers registered = RegisterMarkers(clouds, arguments.rod);
  WriteRecording(registered.recording, arguments.output);
  fmt::print(
      "{}: {} markers, {:.1f} mm apart; {:.0f} % of them are found in a frame, {:.1f} mm from "
      "where they are expected\n",
      arguments.output, registered.recording.point_count(), 1e3 * registered.spacing,
      100 * registered.seen, 1e3 * registered.distance);
  WarnOfDoubts(registered);
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
  if (arguments.markers) return RunMarkers(arguments, clouds);
  const RegisteredClouds registered =
      arguments.like.empty() ? RegisterClouds(clouds, arguments.points)
                             : RegisterCloudsLike(clouds, ReadRecording(arguments.like));
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
