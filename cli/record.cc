// SPDX-License-Identifier: Apache-2.0
// physpring record: a MuJoCo scene -> a recording.
#include "rollout/record.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/picture_words.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "rollout/mujoco_library.h"
#include "twin/error.h"
#include "twin/output_lock.h"

namespace physpring {
namespace {

CLI::Validator IsEffect() {
  CLI::Validator check(
      [](std::string& text) {
        try {
          ParseEffect(text);
        } catch (const Error& error) {
          return std::string(error.what());
        }
        return std::string();
      },
      "");
  return check;
}

SceneEffects EffectsOf(const std::vector<std::string>& words) {
  SceneEffects effects;
  for (const std::string& word : words) {
    const auto [name, value] = ParseEffect(word);
    if (!effects.emplace(name, value).second) {
      throw CLI::ValidationError("--effect", name + " is given twice");
    }
  }
  return effects;
}

std::string ListEffects() {
  std::string list = "Effects, by name, with what MuJoCo does:\n";
  for (const EffectKey& key : EffectKeys()) {
    list += fmt::format("  {:<38} {}\n", key.name, key.what);
  }
  return list;
}

// Ends by Interrupted where a signal comes before there is anything to write.
Recording Simulate(const std::string& scene, RecordOptions options) {
  Progress progress(0);
  if (!options.pictures.folder.empty()) {  // otherwise it does not take long
    options.progress = [&](double part) { progress.Show(part, "pictures"); };
  }
  return UnlessStopped([&] { return RecordScene(scene, options); });
}

void Run(const std::string& scene, const std::string& output, bool force,
         const RecordOptions& options) {
  ExpectMujoco();
  const PictureOptions& pictures = options.pictures;
  ExpectOutputs({output}, {scene, pictures.folder});
  const OutputLock lock(output);
  ExpectNew(output, force);
  const Recording recording = Simulate(scene, options);
  WriteRecording(recording, output);
  PrintRemarks({&recording, 1});
  fmt::print("{}: {} frames at {} fps, {} points, {} interior, {} controllers, {:.4g} kg\n", output,
             recording.frame_count(), recording.fps, recording.point_count(),
             recording.interior_count(), recording.controller_count(), recording.mass);
  if (!pictures.folder.empty()) {
    fmt::print("{}: {} pictures of {} x {} pixels by each of {} cameras\n", pictures.folder,
               recording.frame_count(), pictures.width, pictures.height, pictures.cameras.size());
  }
}

struct RecordArguments {
  std::string scene, output;
  std::vector<std::string> effects;
  bool force = false;
  std::vector<int> size{640, 480};  // of pictures, pixels
  RecordOptions options;
};

// How the object is moved, and what a camera sees of it.
void AddMeasurementOptions(CLI::App* command, RecordOptions* options) {
  command->add_option("--noise", options->noise, "standard deviation of each coordinate")
      ->check(NumberBetween(0, 1))
      ->type_name("METRES")
      ->capture_default_str();
  command->add_option("--occlusion", options->occlusion, "fraction of points hidden in each frame")
      ->check(NumberBetween(0, 0.99))
      ->type_name("FRACTION")
      ->capture_default_str();
  command->add_option("--vary", options->vary, "shift keyframes by up to this: another motion")
      ->check(NumberBetween(0, 10))
      ->type_name("METRES")
      ->capture_default_str();
  AddSeed(command, &options->seed, "of noise, occlusion and variation");
  command->add_option("--duration", options->duration, "default: until the last keyframe")
      ->check(NumberBetween(1e-6, 1e6))
      ->type_name("SECONDS");
  command->add_option("--fps", options->fps, "frames per second")
      ->check(NumberBetween(0.1, 10000))
      ->type_name("NUMBER")
      ->capture_default_str();
}

void AddPictureOptions(CLI::App* command, RecordArguments* arguments) {
  PictureOptions* pictures = &arguments->options.pictures;
  CLI::Option* folder =
      command
          ->add_option("--pictures", pictures->folder,
                       "new folder for what cameras see in each frame: colours, masks, depths")
          ->check(NotEmpty())
          ->type_name("DIR");
  CLI::Option* cameras = command
                             ->add_option("--cameras", pictures->cameras,
                                          "those of the scene that take pictures, none of which "
                                          "may move")
                             ->delimiter(',')
                             ->type_name("NAME,...");
  folder->needs(cameras);
  cameras->needs(folder);
  command->add_option("--size", arguments->size, "of pictures, in pixels")
      ->expected(2)
      ->delimiter(',')
      ->check(WholeNumberBetween(16, 4096))
      ->needs(folder)
      ->type_name("WIDTH,HEIGHT")
      ->default_str("640,480");
  AddChoice(command, "--quality", &pictures->quality, kQualityWords,
            "of pictures: without shadows, or as the scene has it")
      ->needs(folder);
}

}  // namespace

void AddRecordCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "record",
      "Simulates a MuJoCo scene with one soft body (a flex, or bodies joined by spatial tendons), "
      "held by mocap bodies that move along the scene's keyframes, and writes what a camera would "
      "have measured.");
  const auto arguments = std::make_shared<RecordArguments>();
  command->add_option("scene", arguments->scene, "scene (MJCF)")
      ->required()
      ->type_name("SCENE.xml");
  command->add_option("-o,--output", arguments->output, "recording to write")
      ->required()
      ->check(FileNameWith(".npz"))
      ->type_name("REC.npz");
  AddMeasurementOptions(command, &arguments->options);
  command
      ->add_option("--effect", arguments->effects,
                   "give the scene this, too, without a word in the recording; may be repeated")
      ->allow_extra_args(false)
      ->check(IsEffect())
      ->type_name("NAME=VALUE");
  AddPictureOptions(command, arguments.get());
  command->footer(ListEffects());
  command->add_flag("--force", arguments->force, "overwrite a file");
  command->callback([arguments] {
    arguments->options.effects = EffectsOf(arguments->effects);
    arguments->options.pictures.width = arguments->size[0];
    arguments->options.pictures.height = arguments->size[1];
    Run(arguments->scene, arguments->output, arguments->force, arguments->options);
  });
}

}  // namespace physpring
