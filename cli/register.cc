// SPDX-License-Identifier: Apache-2.0
// physpring register: clouds of points without names -> a recording of points that are followed.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "exporter/mesh_place.h"
#include "exporter/mesh_samples.h"
#include "registration/cloud_particles.h"
#include "registration/refine_names.h"
#include "registration/register_clouds.h"
#include "registration/register_markers.h"
#include "trainer/data/fit_data.h"
#include "trainer/fits/train.h"
#include "twin/error.h"
#include "twin/predict.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

struct RegisterArguments {
  std::string recording, like, shape, output;
  int points = 0, threads = AllCores();
  bool refine = false;
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

RegisteredClouds OnShape(const RegisterArguments& arguments, const Recording& clouds) {
  constexpr int kSamples = 16;  // of the mesh, by the points to make
  ExpectSeen(clouds, 1);
  const PlacedMesh placed = ReadMeshAt(arguments.shape, PointsOf(clouds.surface[0]));
  PrintWarnings(placed.warnings);
  const Points samples =
      SampleSurface(placed.mesh, kSamples * std::max(arguments.points, kMostMadePoints));
  return RegisterCloudsOn(clouds, samples, arguments.points);
}

RegisteredClouds RegisterAsAsked(const RegisterArguments& arguments, const Recording& clouds) {
  if (!arguments.shape.empty()) return OnShape(arguments, clouds);
  if (arguments.like.empty()) return RegisterClouds(clouds, arguments.points);
  return RegisterCloudsLike(clouds, ReadRecording(arguments.like));
}

// The motion that a twin predicts which is fitted to the recording.
std::vector<Points> FitAndPredictWith(const Recording& recording, int round, int threads,
                                      Progress* progress) {
  const double share = 1.0 / kMostNamingRounds;
  Journal journal;
  journal.progress = [&](double done, const std::string& status) {
    StopIfRequested();
    progress->Show((round + done) * share, fmt::format("fit {} to {} frames, {}", round + 1,
                                                       recording.train_frames, status));
  };
  const FitData data = CollectFitData({{recording.name}}, {AsReadBack(recording)});
  TrainOptions options;
  options.threads = threads;
  const Twin twin = Train(data, options, {}, Work(&journal, PieceKey("names")));
  return Predict(twin, 0, ByClockOf(twin, data).recordings[0], {});
}

RegisteredClouds Refine(const RegisteredClouds& registered, int threads) {
  Progress progress(0);
  const RefinedNames refined = RefineNames(registered, [&](const Recording& recording, int round) {
    return FitAndPredictWith(recording, round, threads, &progress);
  });
  const int frames = registered.recording.train_frames;
  progress.Say(
      fmt::format("named anew by {} {}; the last one explains {} of the {} frames that are "
                  "for fitting",
                  refined.fits, refined.fits == 1 ? "fit" : "fits", refined.explained, frames));
  if (refined.explained < frames) {
    PrintWarnings(
        {fmt::format("from frame {} on no fit explains the clouds: names may be wrong there",
                     refined.explained)});
  }
  return refined.registered;
}

void Run(const RegisterArguments& arguments) {
  ExpectOutputs({arguments.output}, {arguments.recording, arguments.like, arguments.shape});
  ExpectNew(arguments.output, arguments.force);
  const Recording clouds = ReadRecordingOrClouds(arguments.recording);
  if (clouds.point_count() > 0) {
    throw Error(arguments.recording +
                ": has 'points' already; without them, points are made of its clouds");
  }
  PrintRemarks({&clouds, 1});
  if (arguments.markers) return RunMarkers(arguments, clouds);
  RegisteredClouds registered = RegisterAsAsked(arguments, clouds);
  if (arguments.refine && !registered.lost) {
    registered = UnlessStopped([&] { return Refine(registered, arguments.threads); });
  }
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
  command
      ->add_option("--shape", arguments->shape,
                   "surface of the whole object as it is in frame 0 (OBJ, PLY, STL, GLB), of which "
                   "the clouds may show one side only; glTF is turned from y up to z up")
      ->excludes("--like")
      ->type_name("FILE");
  CLI::Option* refine = command->add_flag(
      "--refine", arguments->refine,
      "fit twins to the points, and name them anew where those predict them; some minutes");
  AddThreads(command, &arguments->threads, "of --refine; the result does not depend on it")
      ->needs(refine);
  CLI::Option* markers = command->add_flag(
      "--markers", arguments->markers,
      "the points are markers, the same ones in each frame in any order; some may be hidden");
  markers->excludes("--points")->excludes("--like")->excludes("--shape")->excludes(refine);
  command->add_flag("--rod", arguments->rod, "the markers are along a rod: write their `order`")
      ->needs(markers);
  command->add_flag("--force", arguments->force, "overwrite a file");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
