// SPDX-License-Identifier: Apache-2.0
#include "cli/rollout_recording.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "cli/eval_report.h"
#include "cli/interrupt.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "rollout/controller_replay.h"
#include "rollout/plugin_library.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/evaluate.h"

namespace physpring {
namespace {

// Loads the plugin, which a scene of tendons does not need. Empty, or why it could not be.
std::string WhyNoPlugin() {
  try {
    LoadPluginLibrary();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Over all frames after the first one.
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

}  // namespace

void RolloutRecording(const RecordingRollout& rollout) {
  const std::string missing = WhyNoPlugin();
  ExpectOutputs({rollout.video, rollout.json}, {rollout.scene, rollout.recording, rollout.twin});
  const Recording recording = ReadRecording(rollout.recording);
  for (const std::string& warning : recording.warnings) {
    fmt::print(stderr, "warning: {}\n", warning);
  }
  std::optional<Twin> twin;
  if (!rollout.twin.empty()) twin = ReadTwin(rollout.twin);

  const InterruptWatch watch;
  Progress progress(0);
  ReplayOptions options;
  options.video = rollout.video;
  options.cameras = rollout.cameras;
  options.quality = rollout.quality;
  options.progress = [&](int frame) {
    if (watch.signal() != 0) throw Interrupted{watch.signal()};
    progress.Show(static_cast<double>(frame) / recording.frame_count(),
                  fmt::format("frame {} of {}", frame, recording.frame_count()));
  };
  ControllerReplay replay;
  try {
    replay = ReplayControllers(rollout.scene, recording, twin ? &*twin : nullptr, options);
  } catch (const Error& error) {
    if (missing.empty()) throw;
    throw Error(fmt::format("{}; {}", error.what(), missing));
  }
  for (const std::string& warning : replay.warnings) fmt::print(stderr, "warning: {}\n", warning);

  const ErrorMeans errors = Compare(recording, replay.particles);
  const std::vector<Points> still(replay.particles.size(), replay.particles[0]);
  const ErrorMeans motionless = Compare(recording, still);
  const double fps = (recording.frame_count() - 1) / std::max(1e-9, replay.physics);
  fmt::print("{} as {} moved: {} frames at {} fps\n\n", rollout.scene, rollout.recording,
             recording.frame_count(), recording.fps);
  fmt::print("{:<10} {:>6} {:>8} {:>13} {:>11} | {:>8} {:>8}\n", "in mm", "nodes", "steps",
             "time step ms", "FPS", "CD", "track");
  fmt::print("{}", ReplayRow(fmt::format("level {}", replay.level),
                             fmt::format("{:>6} {:>8} {:>13.4g} {:>11.0f}", replay.nodes,
                                         replay.steps, 1e3 * replay.timestep, fps),
                             errors));
  fmt::print("{}", ReplayRow("motionless", "", motionless));
  if (!rollout.video.empty()) {
    fmt::print("\nvideo: {}, drawn in {:.2g} s\n", rollout.video, replay.rendering);
  }
  if (rollout.json.empty()) return;
  const nlohmann::ordered_json json = {{"scene", rollout.scene},
                                       {"recording", rollout.recording},
                                       {"level", replay.level},
                                       {"nodes", replay.nodes},
                                       {"timestep_s", replay.timestep},
                                       {"steps", replay.steps},
                                       {"frames", recording.frame_count()},
                                       {"errors", ErrorsAsJson(errors)},
                                       {"motionless", ErrorsAsJson(motionless)},
                                       {"physics_s", replay.physics},
                                       {"rendering_s", replay.rendering}};
  WriteFileAtomically(rollout.json, json.dump(2) + "\n");
}

}  // namespace physpring
