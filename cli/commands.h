// SPDX-License-Identifier: Apache-2.0
// The subcommands of `physpring`, one file each. Add...Command(app) gives `app` the subcommand, its
// flags and a callback: flags -> options -> one library call -> report. A callback throws Error.
#ifndef PHYSPRING_CLI_COMMANDS_H_
#define PHYSPRING_CLI_COMMANDS_H_

#include <CLI/CLI.hpp>

namespace physpring {

void AddRecordCommand(CLI::App& app);
void AddTrainCommand(CLI::App& app);
void AddEvalCommand(CLI::App& app);
void AddTrackCommand(CLI::App& app);
void AddExportCommand(CLI::App& app);
void AddFitSplatsCommand(CLI::App& app);
void AddDiagnoseCommand(CLI::App& app);
void AddReplayCommand(CLI::App& app);
void AddRolloutCommand(CLI::App& app);
void AddMergeCommand(CLI::App& app);
void AddInfoCommand(CLI::App& app);
void AddInteriorCommand(CLI::App& app);
void AddRegisterCommand(CLI::App& app);
void AddSplitCommand(CLI::App& app);
void AddSplatsCommand(CLI::App& app);
void AddDoctorCommand(CLI::App& app);

}  // namespace physpring

#endif  // PHYSPRING_CLI_COMMANDS_H_
