// SPDX-License-Identifier: Apache-2.0
// physpring splats: a twin and splats of its object -> splats that move with it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "splats/placement.h"
#include "splats/settle.h"
#include "splats/splat_file.h"
#include "splats/splat_motion.h"
#include "twin/atomic_file.h"
#include "twin/clock_offset.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/output_lock.h"
#include "twin/predict.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

struct SplatsArguments {
  std::string twin, splats, recording, folder;
  int level = 0, every = 1, threads = AllCores();
  double scale = 1;
  std::vector<double> position{0, 0, 0}, quaternion{1, 0, 0, 0};
  bool force = false;
};

// Where the nodes are, frame by frame; without a recording the twin's reference configuration.
std::vector<Points> NodesOf(const SplatsArguments& arguments) {
  const Twin trained = ReadTwin(arguments.twin);
  if (arguments.recording.empty()) {
    const SpringMassSystem& system = LevelOf(trained, arguments.level).system;
    return {system.position.leftCols(system.node_count())};
  }
  Recording recording = ReadRecordingFor(trained, arguments.recording);
  ExpectSameObject(trained, recording);
  const Twin twin = HeldAsIn(&recording, trained);
  PrintRemarks({&recording, 1});
  return Predict(twin, arguments.level, recording, {});
}

Placement PlacementOf(const SplatsArguments& arguments) {
  const std::vector<double>& q = arguments.quaternion;
  const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  constexpr double kLeast = 1e-6;
  if (!(turn.norm() > kLeast)) throw Error("--quaternion must not be zero");
  return {arguments.scale, turn.normalized(),
          Eigen::Map<const Eigen::Vector3d>(arguments.position.data())};
}

void PrintCheck(const SplatsArguments& arguments, const Splats& splats, const Points& nodes) {
  const PlacementCheck check = CheckPlacement(splats, nodes);
  fmt::print("{}: {} splats, harmonics to degree {}; half of them within {:.1f} mm of a node\n",
             arguments.splats, splats.count(), splats.degree, 1e3 * check.median);
  fmt::print("  nine tenths of them, along each axis: {}\n  the twin's nodes: {}\n",
             BoxText(check.low, check.high), BoxText(check.node_low, check.node_high));
  PrintWarnings(WarningsOf(check, arguments.splats));
}

// Files of an earlier run, which a viewer would take for frames of this one.
void WarnOfOthers(const std::string& folder, std::size_t written) {
  std::size_t frames = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    frames += name.starts_with("frame_") && name.ends_with(".ply") ? 1 : 0;
  }
  if (frames <= written) return;
  PrintWarnings({fmt::format("{}: has {} files frame_*.ply of an earlier run, too", folder,
                             frames - written)});
}

void WriteFrames(const SplatsArguments& arguments, const Splats& splats,
                 const std::vector<Points>& nodes) {
  const auto path = [&](std::size_t frame) {
    return (std::filesystem::path(arguments.folder) / fmt::format("frame_{:05}.ply", frame))
        .string();
  };
  std::vector<std::size_t> frames;
  for (std::size_t frame = 0; frame < nodes.size(); frame += arguments.every) {
    frames.push_back(frame);
    ExpectNew(path(frame), arguments.force);
    std::error_code unlike;  // as where one is not there
    if (std::filesystem::equivalent(path(frame), arguments.splats, unlike)) {
      throw Error(path(frame) + ": is the input; use another folder");
    }
  }
  const OutputFolder folder(arguments.folder);
  const OutputLock lock(arguments.folder);
  const SplatMotion motion(splats, nodes[0]);
  const InterruptWatch watch;
  Progress progress(0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (watch.signal() != 0) {
      Tell("physpring: stopped; {} of {} frames are written\n", i, frames.size());
      throw Interrupted{watch.signal()};
    }
    WriteSplats(Settle(motion.At(nodes[frames[i]], arguments.threads)), path(frames[i]));
    progress.Show(static_cast<double>(i + 1) / static_cast<double>(frames.size()),
                  fmt::format("frame {} of {}", i + 1, frames.size()));
  }
  fmt::print("{} files, {} to {}\n", frames.size(), path(frames.front()), path(frames.back()));
  WarnOfOthers(arguments.folder, frames.size());
}

void Run(const SplatsArguments& arguments) {
  const Splats splats = Place(ReadSplats(arguments.splats), PlacementOf(arguments));
  const std::vector<Points> nodes = NodesOf(arguments);
  PrintCheck(arguments, splats, nodes[0]);
  if (!arguments.folder.empty()) WriteFrames(arguments, splats, nodes);
}

void AddPlacementOptions(CLI::App* command, SplatsArguments* arguments) {
  command->add_option("--scale", arguments->scale, "metres a unit of the splats' file")
      ->check(NumberBetween(1e-6, 1e6))
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--position", arguments->position,
                   "where the origin of the splats' file is in the twin's frame")
      ->expected(3)
      ->check(NumberBetween(-1e6, 1e6))
      ->delimiter(',')
      ->type_name("X,Y,Z")
      ->default_str("0,0,0");
  command
      ->add_option("--quaternion", arguments->quaternion,
                   "how the splats' file is turned in the twin's frame")
      ->expected(4)
      ->check(NumberBetween(-1e6, 1e6))
      ->delimiter(',')
      ->type_name("W,X,Y,Z")
      ->default_str("1,0,0,0");
}

}  // namespace

void AddSplatsCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "splats",
      "Moves splats (3-D Gaussians) of an object with its twin: a .ply file a frame, for viewers.");
  const auto arguments = std::make_shared<SplatsArguments>();
  command->add_option("twin", arguments->twin, "twin")->required()->type_name("TWIN.twin.npz");
  command
      ->add_option("splats", arguments->splats,
                   "of the object alone, as in the recording's frame 0, or the twin's reference")
      ->required()
      ->type_name("SPLATS.ply");
  CLI::Option* recording =
      command
          ->add_option("--recording", arguments->recording,
                       "whose motion the twin predicts; without one only the place is checked")
          ->type_name("REC.npz");
  command
      ->add_option("-o,--output", arguments->folder,
                   "folder for frame_00000.ply ..., for which a recording is needed")
      ->check(NotEmpty())
      ->needs(recording)
      ->type_name("DIR");
  command->add_option("--level", arguments->level, "of the twin")
      ->check(WholeNumberBetween(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--every", arguments->every, "write only every n-th frame")
      ->check(WholeNumberBetween(1, 1000000))
      ->type_name("N")
      ->capture_default_str();
  AddPlacementOptions(command, arguments.get());
  AddThreads(command, &arguments->threads, "that turn and stretch splats");
  command->add_flag("--force", arguments->force, "overwrite files");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
