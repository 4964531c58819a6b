// SPDX-License-Identifier: Apache-2.0
// The program `physpring`. Exit status: 0 done, 1 failed (one line on stderr), 2 bad usage, 128 + n
// stopped by signal n (after Ctrl-C 130).
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <system_error>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/standard_streams.h"

namespace {

// One line for a command that cannot be understood, naming the page that explains it.
std::string DescribeBadUsage(const CLI::App* app, const CLI::Error& error) {
  std::string command = app->get_name();
  for (const CLI::App* subcommand : app->get_subcommands()) command += " " + subcommand->get_name();
  return command + ": " + error.what() + " (see " + command + " --help)\n";
}

// What `physpring rollout SCENE --controllers REC` did has a command of its own.
void RenameOldReplay(int argc, char** argv) {
  static char replay[] = "replay";
  if (argc < 2 || std::string(argv[1]) != "rollout") return;
  const bool old = std::any_of(argv + 2, argv + argc, [](const std::string& argument) {
    return argument == "--controllers" || argument.starts_with("--controllers=");
  });
  if (!old) return;
  std::fputs("note: rollout --controllers is now physpring replay\n", stderr);
  argv[1] = replay;
}

// Says what went wrong, in one line.
int Fail(const std::string& what) {
  std::fprintf(stderr, "physpring: %s\n", what.c_str());
  return 1;
}

// One that was interrupted or used badly says so even if its output is lost.
int FailUnlessPrinted(int status) {
  const std::string why = physpring::WhyNotPrinted();
  return status != 0 || why.empty() ? status : Fail("standard output: cannot be written: " + why);
}

int RunProgram(int argc, char** argv) {
  CLI::App app("Learns spring-mass twins of deformable objects from recordings.", "physpring");
  app.set_version_flag("--version", "physpring " PHYSPRING_VERSION);
  app.require_subcommand(1);
  app.failure_message(DescribeBadUsage);
  physpring::AddRecordCommand(app);
  physpring::AddTrainCommand(app);
  physpring::AddEvalCommand(app);
  physpring::AddTrackCommand(app);
  physpring::AddExportCommand(app);
  physpring::AddDiagnoseCommand(app);
  physpring::AddReplayCommand(app);
  physpring::AddRolloutCommand(app);
  physpring::AddMergeCommand(app);
  physpring::AddInfoCommand(app);
  physpring::AddInteriorCommand(app);
  physpring::AddRegisterCommand(app);
  physpring::AddSplitCommand(app);
  physpring::AddFitSplatsCommand(app);
  physpring::AddSplatsCommand(app);
  physpring::AddDoctorCommand(app);
  const auto is_named = [&](const CLI::App* command) { return command->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_named).empty()) {
    std::fprintf(stderr, "physpring: unknown command %s (see physpring --help)\n", argv[1]);
    return 2;
  }
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {  // also how --help and --version end
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const physpring::Interrupted& interrupted) {
    return 128 + interrupted.signal;
  } catch (const std::system_error& error) {  // printing throws it, too
    if (std::ferror(stdout) == 0) return Fail(error.what());
    return Fail("standard output: cannot be written: " + error.code().message());
  } catch (const std::exception& error) {
    return Fail(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit is a failed write like others
  physpring::OpenClosedStreams();
  RenameOldReplay(argc, argv);
  return FailUnlessPrinted(RunProgram(argc, argv));
}
