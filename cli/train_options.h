// SPDX-License-Identifier: Apache-2.0
// The options that the result of a training depends on, listed once: as flags of `physpring train`,
// and as the JSON that a twin keeps and that --resume compares.
#ifndef PHYSPRING_CLI_TRAIN_OPTIONS_H_
#define PHYSPRING_CLI_TRAIN_OPTIONS_H_

#include <CLI/CLI.hpp>
#include <string>

#include "trainer/data/train_options.h"

namespace physpring {

// Adds all flags but the seed's, which all commands have. `options` must outlive the command.
void AddTrainFlags(CLI::App* command, TrainOptions* options);

// {"method": "full", ...}: a key for each flag, and the effects. `from`: the file that level 0
// comes from; empty: it is fitted. The seed has a place of its own in a twin.
std::string TrainOptionsJson(const TrainOptions& options, const std::string& from);

}  // namespace physpring

#endif  // PHYSPRING_CLI_TRAIN_OPTIONS_H_
