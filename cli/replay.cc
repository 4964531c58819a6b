// SPDX-License-Identifier: Apache-2.0
// physpring replay: an exported twin in MuJoCo, moved as in a recording and compared with it.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/picture_words.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "report/eval_report.h"
#include "rollout/controller_replay.h"
#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "twin/atomic_file.h"
#include "twin/checks/motion_scale.h"
#include "twin/checks/plausibility.h"
#include "twin/clock_offset.h"
#include "twin/error.h"
#include "twin/evaluate.h"
#include "twin/predict.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

struct ReplayArguments {
  std::string scene, recording;
  std::string twin;                  // a file; empty: none
  std::string video, json;           // files to write; empty: none
  std::vector<std::string> cameras;  // those that the video shows
  PictureQuality quality = PictureQuality::kFast;
};

// The replay with progress. Throws Interrupted where a signal stops it.
ControllerReplay Replay(const ReplayArguments& arguments, const std::optional<Twin>& twin,
                        const Recording& recording) {
  const InterruptWatch watch;
  Progress progress(0);
  ReplayOptions options;
  options.video = arguments.video;
  options.cameras = arguments.cameras;
  options.quality = arguments.quality;
  options.progress = [&](int frame) {
    if (watch.signal() != 0) throw Interrupted{watch.signal()};
    progress.Show(static_cast<double>(frame) / recording.frame_count(),
                  fmt::format("frame {} of {}", frame, recording.frame_count()));
  };
  return ReplayControllers(arguments.scene, recording, twin ? &*twin : nullptr, options);
}

// Loads the plugin, which a scene of tendons does not need. Returns why it could not be loaded;
// empty if it could.
std::string WhyNoPlugin() {
  try {
    LoadPluginLibrary();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// The mean errors over all frames after the first one.
ErrorMeans Compare(const Recording& recording, const std::vector<Points>& particles) {
  return MeansOverFrames(ComputeParticleErrors(recording, particles), 1, recording.frame_count());
}

std::string ReplayRow(const std::string& name, const std::string& model, const ErrorMeans& errors) {
  return fmt::format("{:<10} {:>41} | {:>8} {:>8}\n", name, model, Millimetres(errors.cd.value),
                     Millimetres(errors.track.value));
}

nlohmann::ordered_json ErrorsAsJson(const ErrorMeans& errors) {
  nlohmann::ordered_json json;
  json["cd"] = json["track"] = nullptr;
  if (errors.cd.value) json["cd"] = *errors.cd.value;
  if (errors.track.value) json["track"] = *errors.track.value;
  return json;
}

// The errors of the replay, and those of a body that does not move.
struct ReplayErrors {
  ErrorMeans replayed, motionless;
};

ReplayErrors ErrorsOf(const ControllerReplay& replay, const Recording& recording) {
  const std::vector<Points> still(replay.particles.size(), replay.particles[0]);
  return {Compare(recording, replay.particles), Compare(recording, still)};
}

void PrintTable(const ReplayArguments& arguments, const Recording& recording,
                const ControllerReplay& replay, const ReplayErrors& errors) {
  const double fps = (recording.frame_count() - 1) / std::max(1e-9, replay.physics);
  fmt::print("{} as {} moved: {} frames at {} fps\n\n", arguments.scene, arguments.recording,
             recording.frame_count(), recording.fps);
  fmt::print("{:<10} {:>6} {:>8} {:>13} {:>11} | {:>8} {:>8}\n", "in mm", "nodes", "steps",
             "time step ms", "FPS", "CD", "track");
  fmt::print("{}", ReplayRow(fmt::format("level {}", replay.level),
                             fmt::format("{:>6} {:>8} {:>13.4g} {:>11.0f}", replay.nodes,
                                         replay.steps, 1e3 * replay.timestep, fps),
                             errors.replayed));
  fmt::print("{}", ReplayRow("motionless", "", errors.motionless));
  if (!arguments.video.empty()) {
    fmt::print("\nvideo: {}, drawn in {:.2g} s\n", arguments.video, replay.rendering);
  }
}

void WarnIfUseless(const Recording& recording, const ReplayErrors& errors) {
  const auto &track = errors.replayed.track.value, &still = errors.motionless.track.value;
  if (!track || !still) return;
  const std::string little = TooLittleExplained(*track, *still, MeasurementNoise(recording.points));
  if (!little.empty()) PrintWarnings({recording.name + ": " + little});
}

void WriteReport(const ReplayArguments& arguments, const Recording& recording,
                 const ControllerReplay& replay, const ReplayErrors& errors) {
  const nlohmann::ordered_json json = {{"scene", arguments.scene},
                                       {"recording", arguments.recording},
                                       {"level", replay.level},
                                       {"nodes", replay.nodes},
                                       {"timestep_s", replay.timestep},
                                       {"steps", replay.steps},
                                       {"frames", recording.frame_count()},
                                       {"errors", ErrorsAsJson(errors.replayed)},
                                       {"motionless", ErrorsAsJson(errors.motionless)},
                                       {"physics_s", replay.physics},
                                       {"rendering_s", replay.rendering}};
  WriteFileAtomically(arguments.json, json.dump(2) + "\n");
}

// A scene does not say how far the clocks of a recording differ; its twin does.
void UseClock(const ReplayArguments& arguments, const std::optional<Twin>& twin,
              Recording* recording) {
  if (!recording->two_clocks) return;
  if (twin) return UseClockOf(*twin, recording);
  recording->warnings.push_back(arguments.recording +
                                ": its controllers have a clock of their own, and without --twin "
                                "nobody knows how far it is off");
}

// The scene holds the object where the training did.
void WarnOfMovedGrasps(const Twin& twin, Recording* recording) {
  ExpectSameObject(twin, *recording);
  if (twin.TrainingOn(recording->hash)) return;
  for (const MovedGrasp& moved : FindMovedGrasps(twin.levels[0].system.position, *recording)) {
    recording->warnings.push_back(fmt::format(
        "recording {}: controller {} holds the object {:.3g} m from where it held it in the "
        "training, and as the scene does",
        recording->name, moved.controller, moved.distance));
  }
}

void Run(const ReplayArguments& arguments) {
  ExpectMujoco();
  const std::string missing = WhyNoPlugin();
  ExpectOutputs({arguments.video, arguments.json},
                {arguments.scene, arguments.recording, arguments.twin});
  Recording recording = ReadRecording(arguments.recording);
  std::optional<Twin> twin;
  if (!arguments.twin.empty()) twin = ReadTwin(arguments.twin);
  UseClock(arguments, twin, &recording);
  if (twin) WarnOfMovedGrasps(*twin, &recording);
  PrintRemarks({&recording, 1});
  ControllerReplay replay;
  try {
    replay = Replay(arguments, twin, recording);
  } catch (const Error& error) {
    if (missing.empty()) throw;
    throw Error(fmt::format("{}; {}", error.what(), missing));
  }
  PrintWarnings(replay.warnings);
  const ReplayErrors errors = ErrorsOf(replay, recording);
  if (!arguments.json.empty()) WriteReport(arguments, recording, replay, errors);
  PrintTable(arguments, recording, replay, errors);
  WarnIfUseless(recording, errors);
}

}  // namespace

void AddReplayCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("replay",
                                         "Moves an exported twin in MuJoCo as in a recording, and "
                                         "compares it with what was measured.");
  const auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("scene", arguments->scene, "a scene that physpring export wrote")
      ->required()
      ->type_name("SCENE.xml");
  command
      ->add_option("--controllers", arguments->recording,
                   "a recording: the twin's controllers go where its controllers went")
      ->required()
      ->type_name("REC");
  command
      ->add_option(
          "--twin", arguments->twin,
          "of the scene, where its level is above 0: to start from the recording and to be "
          "compared with it")
      ->type_name("TWIN");
  CLI::Option* video =
      command
          ->add_option("--video", arguments->video,
                       "film it (.mp4, or _%04d.png for a picture a frame); needs ffmpeg")
          ->type_name("FILE");
  command
      ->add_option("--cameras", arguments->cameras,
                   "in the video, side by side; default: the first one of the scene")
      ->delimiter(',')
      ->needs(video)
      ->type_name("NAME,...");
  AddChoice(command, "--quality", &arguments->quality, kQualityWords,
            "of pictures; high: shadows, smooth edges, round shapes");
  command->add_option("--json", arguments->json, "report to write")->type_name("FILE");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
