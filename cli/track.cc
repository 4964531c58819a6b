// SPDX-License-Identifier: Apache-2.0
// physpring track: a twin and what is seen of its object -> where all of it is.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/track_stream.h"
#include "cli/warnings.h"
#include "jobs/tracking.h"
#include "tracker/track_recording.h"
#include "twin/npz_fields.h"
#include "twin/predict.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

struct TrackArguments {
  std::string twin, recording, output;
  TrackOptions options;
  bool force = false;
  bool stream = false;
  LiveOptions stream_options;
};

void PrintErrors(const TrackArguments& arguments, const TrackedMotion& motion) {
  const TrackErrors& errors = motion.errors;
  const auto print = [](const char* what, double metres) {
    if (std::isfinite(metres)) fmt::print("  {:<42} {:>8.2f} mm\n", what, 1e3 * metres);
  };
  if (motion.cloud) {
    fmt::print("clouds are from the nearest particles, mean of the last second:\n");
    print("tracked", motion.cloud->distance);
    print("predicted from frame 0, nothing measured", motion.predicted_cloud_distance);
  }
  if (motion.hidden.empty()) {
    fmt::print("no point was {}\n", arguments.options.cloud
                                        ? "measured, so only the clouds tell how good this is"
                                        : "hidden, so nothing tells how good this is (--hide)");
    return;
  }
  fmt::print("mean distance of {} points that were {}:\n", motion.hidden.size(),
             arguments.options.cloud ? "measured, but not told" : "hidden");
  print("tracked", errors.tracked);
  print("predicted from frame 0, nothing measured", errors.predicted);
  print("interpolated between those seen, no twin", errors.interpolated);
}

void Run(const TrackArguments& arguments) {
  if (arguments.stream) {
    LiveOptions options = arguments.stream_options;
    options.substeps = arguments.options.substeps;
    return TrackStream(arguments.twin, options);
  }
  ExpectOutputs({arguments.output}, {arguments.twin, arguments.recording});
  ExpectNew(arguments.output, arguments.force);
  const Twin trained = ReadTwin(arguments.twin);
  Recording recording =
      RecordingToTrack(trained, ReadRecordingOrClouds(arguments.recording), arguments.options);
  ExpectSameObject(trained, recording);
  const Twin twin = HeldAsIn(&recording, trained);
  PrintRemarks({&recording, 1});
  const TrackedMotion motion = TrackRecording(twin, recording, arguments.options);
  Npz arrays;
  arrays["position"] = StoreFrames(motion.position);
  arrays["velocity"] = StoreFrames(motion.velocity);
  arrays["fps"] = NpzArray::Doubles({}, &recording.fps);
  arrays["hidden"] = NpzArray::Ints({motion.hidden.size()}, motion.hidden.data());
  WriteNpz(arrays, arguments.output);
  fmt::print("{}: {} particles in {} frames, {:.0f} frames a second ({:.1f} x real time)\n",
             arguments.output, motion.position[0].cols(), motion.position.size(),
             motion.frames_per_second, motion.frames_per_second / recording.fps);
  if (motion.softened > 0) {
    fmt::print("{} sub-steps a frame, for which {:.0f} % of the springs are softened\n",
               motion.substeps, 100 * motion.softened);
  }
  PrintErrors(arguments, motion);
  PrintWarnings(WarningsOf(motion));
}

}  // namespace

void AddTrackCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "track",
      "Follows a twin's object through a recording that sees only a part of it, and writes where "
      "all its particles are, and how fast.");
  const auto arguments = std::make_shared<TrackArguments>();
  command->add_option("twin", arguments->twin, "twin")->required()->type_name("TWIN.twin.npz");
  CLI::Option* recording =
      command->add_option("recording", arguments->recording, "recording")->type_name("REC.npz");
  CLI::Option* output = command->add_option("-o,--output", arguments->output, "states to write")
                            ->check(FileNameWith(".npz"))
                            ->type_name("STATES.npz");
  CLI::Option* cloud = command->add_flag("--cloud", arguments->options.cloud,
                                         "follow the recording's `surface`, points without names, "
                                         "and judge by its points, if it has any");
  CLI::Option* hide = command
                          ->add_option("--hide", arguments->options.hide,
                                       "hide this part of the points, and judge by them")
                          ->check(NumberBetween(0, 0.95))
                          ->excludes("--cloud")
                          ->type_name("PART");
  AddSeed(command, &arguments->options.seed, "of the points that are hidden");
  command->add_flag("--force", arguments->force, "overwrite a file");
  CLI::Option* stream =
      command
          ->add_flag("--stream", arguments->stream,
                     "instead of a recording: frames on standard input, states on standard output, "
                     "a line of JSON each (docs/track.md)")
          ->excludes(recording)
          ->excludes(output)
          ->excludes(cloud)
          ->excludes(hide);
  command->add_option("--fps", arguments->stream_options.fps, "of the stream; default: the twin's")
      ->check(NumberBetween(0.1, 1e5))
      ->needs(stream)
      ->type_name("1/S");
  command
      ->add_option("--noise", arguments->stream_options.noise,
                   "standard deviation of a coordinate of the stream's points")
      ->capture_default_str()
      ->check(NumberBetween(1e-6, 1))
      ->needs(stream)
      ->type_name("M");
  AddNumberOrAuto(command, "--substeps", &arguments->options.substeps,
                  "a frame; fewer than it takes soften the stiffest nodes: faster, less exact");
  command->callback([arguments, recording, output] {
    if (!arguments->stream && (recording->empty() || output->empty())) {
      throw CLI::RequiredError("a recording and --output, or --stream");
    }
    Run(*arguments);
  });
}

}  // namespace physpring
