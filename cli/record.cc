// SPDX-License-Identifier: Apache-2.0
// physpring record: a MuJoCo scene -> a recording.
#include "rollout/record.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "cli/commands.h"

namespace physpring {
namespace {

void Run(const std::string& scene, const std::string& output, const RecordOptions& options) {
  const Recording recording = RecordScene(scene, options);
  WriteRecording(recording, output);
  for (const std::string& warning : recording.warnings) {
    fmt::print(stderr, "warning: {}\n", warning);
  }
  fmt::print("{}: {} frames at {} fps, {} points, {} interior, {} controllers, {:.4g} kg\n", output,
             recording.frame_count(), recording.fps, recording.point_count(),
             recording.interior_count(), recording.controller_count(), recording.mass);
}

}  // namespace

void AddRecordCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "record",
      "Simulates a MuJoCo scene with one flex, held by mocap bodies that move along the scene's "
      "keyframes, and writes what a camera would have measured.");
  struct Arguments {
    std::string scene, output;
    RecordOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  RecordOptions& options = arguments->options;
  command->add_option("scene", arguments->scene, "scene (MJCF)")
      ->required()
      ->type_name("SCENE.xml");
  command->add_option("-o,--output", arguments->output, "recording to write")
      ->required()
      ->type_name("REC.npz");
  command->add_option("--noise", options.noise, "standard deviation of each coordinate, m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--occlusion", options.occlusion, "fraction of points hidden in each frame")
      ->check(CLI::Range(0.0, 0.99))
      ->capture_default_str();
  command->add_option("--vary", options.vary, "shift keyframes by up to this, m: another motion")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "of noise, occlusion and variation")
      ->capture_default_str();
  command->add_option("--duration", options.duration, "s; default: until the last keyframe")
      ->check(CLI::PositiveNumber);
  command->add_option("--fps", options.fps, "frames per second")
      ->check(CLI::Range(0.1, 10000.0))
      ->capture_default_str();
  command->callback([arguments] { Run(arguments->scene, arguments->output, arguments->options); });
}

}  // namespace physpring
