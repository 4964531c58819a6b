// SPDX-License-Identifier: Apache-2.0
// physpring export: a twin -> a folder of MJCF.
#include "exporter/export.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "exporter/folder.h"
#include "jobs/checkpoint.h"
#include "twin/free_twin.h"

namespace physpring {
namespace {

struct ExportArguments {
  std::string twin, output;
  bool force = false;
  ExportOptions options;
};

// An option that takes one of these words, the first one by default.
template <class Kind>
CLI::Option* AddKind(CLI::App* command, const std::string& name, Kind* kind,
                     const std::vector<std::pair<std::string, Kind>>& kinds,
                     const std::string& description) {
  std::vector<std::string> words;
  for (const auto& [word, value] : kinds) words.push_back(word);
  const auto take = [kind, kinds](const std::string& text) {
    for (const auto& [word, value] : kinds) {
      if (text == word) *kind = value;
    }
  };
  return command->add_option_function<std::string>(name, take, description)
      ->check(CLI::Validator(OneOf(words), ""))
      ->type_name(fmt::format("{}", fmt::join(words, "|")))
      ->default_str(words.front());
}

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

std::string DescribeLevel(const ExportedLevel& level) {
  const LevelPlan& plan = level.plan;
  const SpringMassSystem& system = plan.system();
  std::string text = fmt::format("{}: {} nodes, {} springs, {} controllers; time step {:.4g} ms",
                                 level.model, system.node_count(), system.spring_count(),
                                 system.controllers, 1e3 * plan.timestep);
  if (plan.substep < plan.timestep) {
    text += fmt::format(" with sub-steps of {:.4g} ms", 1e3 * plan.substep);
  }
  text += fmt::format(", largest stable one {}\n", plan.LargestTimestep());
  for (const std::string& difference : plan.differences) text += "  " + difference + "\n";
  if (plan.springs != SpringKind::kFlex) return text;
  const FlexRounding& rounding = level.flexes.rounding;
  return text + fmt::format(
                    "  {} springs in {} flexes, rounded: stiffness by {:.2g} % (at most {:.2g} %), "
                    "damping by {:.2g} N s/m ({:.2g}), rest length at most {:.2g} mm; {} springs "
                    "stay tendons\n",
                    system.spring_count() - static_cast<int>(level.flexes.tendons.size()),
                    level.flexes.groups.size(), 100 * rounding.stiffness_mean,
                    100 * rounding.stiffness_max, rounding.dashpot_mean, rounding.dashpot_max,
                    1e3 * rounding.rest_length_max, level.flexes.tendons.size());
}

void Run(const ExportArguments& arguments, const std::string& command_line) {
  const Twin read = ReadTwin(arguments.twin);
  WarnIfUnfinished(read, arguments.twin);
  const bool free = arguments.options.controllers == ControllerKind::kNone;
  const Twin twin = free ? WithoutControllers(read) : read;
  const Export result = ExportTwin(twin, arguments.options, command_line);
  WriteFolder(arguments.output, result.files, arguments.force);
  for (const std::string& warning : result.warnings) {
    Tell("warning: {}: {}\n", arguments.twin, warning);
  }
  fmt::print("{}\n", arguments.output);
  for (const ExportedLevel& level : result.levels) fmt::print("{}", DescribeLevel(level));
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
  AddKind<SpringKind>(
      command, "--springs", &options->springs,
      {{"auto", SpringKind::kAuto},
       {"tendon", SpringKind::kTendon},
       {"plugin", SpringKind::kPlugin},
       {"flex", SpringKind::kFlex}},
      "what stands for the springs; auto: tendons, the plugin where they would leave "
      "out an effect");
  AddKind<ControllerKind>(
      command, "--controllers", &options->controllers,
      {{"auto", ControllerKind::kAuto},
       {"mocap", ControllerKind::kMocap},
       {"slide", ControllerKind::kSlide},
       {"none", ControllerKind::kNone}},
      "what holds the object; auto: slide where dashpots must feel its velocity; none: it is free");
  AddKind<ContactKind>(command, "--contact", &options->contact,
                       {{"auto", ContactKind::kAuto},
                        {"mujoco", ContactKind::kMujoco},
                        {"plugin", ContactKind::kPlugin},
                        {"none", ContactKind::kNone}},
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
  command->add_flag("--force", arguments->force, "write into a folder that has files in it");
  AddModelOptions(command, &arguments->options);
  command->callback([arguments, command] { Run(*arguments, CommandLine(*command)); });
}

}  // namespace physpring
