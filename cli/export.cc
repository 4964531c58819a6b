// SPDX-License-Identifier: Apache-2.0
// physpring export: a twin -> a folder of MJCF.
#include "jobs/export.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/warnings.h"
#include "exporter/folder.h"
#include "jobs/export_words.h"

namespace physpring {
namespace {

struct ExportArguments {
  std::string twin, output;
  bool force = false;
  ExportOptions options;
  ExportedSamples samples;
};

// `text` as a word for the shell.
std::string ShellWord(const std::string& text) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string word = "'";
  for (const char letter : text)
    word += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return word + "'";
}

// The command as given, with file names instead of paths.
std::string CommandLine(const CLI::App& command) {
  std::string line = "physpring " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->check_name("--force")) continue;
    if (!option->get_snames().empty()) {
      line.append(" -").append(option->get_snames().front());
    } else if (!option->get_lnames().empty()) {
      line.append(" --").append(option->get_lnames().front());
    }
    for (const std::string& value : option->results()) {
      std::filesystem::path path(value);
      if (!path.has_filename()) path = path.parent_path();  // DIR/
      line.append(" ").append(ShellWord(path.filename().string()));
    }
  }
  return line;
}

void Run(const ExportArguments& arguments, const std::string& command_line) {
  const Twin read = ReadTwin(arguments.twin);
  WarnOfTraining(read, arguments.twin);
  const ExportedFolder folder =
      MakeExport(read, arguments.options, command_line, arguments.samples);
  WriteFolder(arguments.output, folder.files, arguments.force);
  for (const std::string& warning : folder.warnings) {
    Tell("warning: {}: {}\n", arguments.twin, warning);
  }
  fmt::print("{}\n{}", arguments.output, folder.text);
}

void AddModelOptions(CLI::App* command, ExportOptions* options) {
  command->add_option("--level", options->level, "one level instead of all")
      ->transform(CLI::Validator(
          [](std::string& text) {
            if (text != "all") return WholeNumberBetween(0, 1000)(text);
            text = "-1";
            return std::string();
          },
          ""))
      ->type_name("N|all")
      ->default_str("all");
  AddChoice(command, "--springs", &options->springs, kSpringWords,
            "what stands for the springs; auto: tendons, the plugin where they would leave out an "
            "effect or take over 4 times as many steps");
  AddChoice(
      command, "--controllers", &options->controllers, kControllerWords,
      "what holds the object; auto: slide where dashpots must feel its velocity; none: it is free");
  AddChoice(command, "--contact", &options->contact, kContactWords,
            "whose contacts; auto: the plugin's if the springs are, else MuJoCo's");
  command->add_option("--flexes", options->flexes, "at most, with --springs flex")
      ->check(WholeNumberBetween(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--timestep", options->timestep,
                   "of the scenes; default: that of the training, with the plugin's springs 0.002")
      ->check(NumberBetween(1e-9, 1))
      ->type_name("SECONDS");
  command
      ->add_option(
          "--mesh", options->mesh,
          "surface to draw (OBJ, PLY, STL, GLB) on which the recording's points are in frame 0; "
          "glTF is turned from y up to z up; default: made from the points")
      ->type_name("FILE");
  command->add_option("--name", options->name, "prefix of all names; default: the twin's name")
      ->check(NotEmpty());
}

}  // namespace

void AddExportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "export", "Writes the levels of a twin as MuJoCo models, with scenes to try them in.");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("twin", arguments->twin, "twin")->required()->type_name("TWIN.twin.npz");
  command->add_option("-o,--output", arguments->output, "folder to write")
      ->required()
      ->check(NotEmpty())
      ->type_name("DIR");
  command->add_flag(
      "--force", arguments->force,
      "write into a folder that has files in it; levels and samples of an earlier export go");
  AddModelOptions(command, &arguments->options);
  command
      ->add_option("--samples", arguments->samples.count,
                   "so many twins beside it that are as likely by the recordings, each in a folder "
                   "sample_NNNN of the same kind: for domain randomisation")
      ->check(WholeNumberBetween(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  AddSeed(command, &arguments->samples.seed, "of the samples");
  command->callback([arguments, command] {
    if (command->count("--flexes") > 0 && arguments->options.springs != SpringKind::kFlex) {
      throw CLI::ValidationError("--flexes", "is of --springs flex");
    }
    Run(*arguments, CommandLine(*command));
  });
}

}  // namespace physpring
