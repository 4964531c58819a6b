// SPDX-License-Identifier: Apache-2.0
// physpring split: a recording of several objects -> a recording of each.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/output_files.h"
#include "cli/warnings.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/split_objects.h"

namespace physpring {
namespace {

struct SplitArguments {
  std::string recording, folder;
  bool force = false;
};

void Run(const SplitArguments& arguments) {
  const Recording recording = ReadRecording(arguments.recording);
  PrintRemarks({&recording, 1});
  const std::vector<Recording> parts = SplitObjects(recording);
  if (parts.size() < 2) {
    throw Error(
        fmt::format("{}: shows one object; the array 'object' can say which points are of which",
                    arguments.recording));
  }
  std::vector<std::string> paths;
  for (const Recording& part : parts) {
    paths.push_back((std::filesystem::path(arguments.folder) / (part.name + ".npz")).string());
    ExpectNew(paths.back(), arguments.force);
  }
  const OutputFolder folder(arguments.folder);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    WriteRecording(parts[i], paths[i]);
    fmt::print("{}: {} points, {} interior, {} controllers, {:.3g} kg\n", paths[i],
               parts[i].point_count(), parts[i].interior_count(), parts[i].controller_count(),
               parts[i].mass);
  }
}

}  // namespace

void AddSplitCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "split", "Makes a recording of each of the objects that a recording shows.");
  const auto arguments = std::make_shared<SplitArguments>();
  command->add_option("recording", arguments->recording, "recording")
      ->required()
      ->type_name("REC.npz");
  command
      ->add_option("-o,--output", arguments->folder,
                   "folder for REC_object0.npz, REC_object1.npz ...; made if missing")
      ->required()
      ->type_name("DIR");
  command->add_flag("--force", arguments->force, "overwrite files");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
