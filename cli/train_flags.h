// SPDX-License-Identifier: Apache-2.0
// The options of a training (jobs/train_option_list.h) as flags of `physpring train`.
#ifndef PHYSPRING_CLI_TRAIN_FLAGS_H_
#define PHYSPRING_CLI_TRAIN_FLAGS_H_

#include <CLI/CLI.hpp>

#include "trainer/data/train_options.h"

namespace physpring {

// Adds all flags but the seed's, which all commands have. `options` must outlive the command.
void AddTrainFlags(CLI::App* command, TrainOptions* options);

}  // namespace physpring

#endif  // PHYSPRING_CLI_TRAIN_FLAGS_H_
