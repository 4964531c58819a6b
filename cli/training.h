// SPDX-License-Identifier: Apache-2.0
// A training run, with progress, log and checkpoints, until it is done or a signal asks it to stop.
#ifndef PHYSPRING_CLI_TRAINING_H_
#define PHYSPRING_CLI_TRAINING_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/checkpoint.h"
#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "twin/twin.h"

namespace physpring {

struct TrainingTask {
  FitData data;
  TrainOptions options;
  std::optional<Twin> dense;  // level 0, where it is not fitted
};

struct TrainingRun {
  Twin twin;           // as written
  int signal = 0;      // that stopped it; 0: it is finished
  double share = 0;    // of the work that is done
  std::string status;  // of the last step
  // Where the time went: parts and seconds, in the order of their first step; the last one is
  // writing checkpoints.
  std::vector<std::pair<std::string, double>> parts;
};

// Writes `checkpoint` at most every `interval` seconds, and at the end. Goes on from it if
// `resume`. Each step and checkpoint is a line of the log (spdlog's default logger).
TrainingRun RunTraining(const TrainingTask& task, const Checkpoint& checkpoint, bool resume,
                        double interval);

// A line for each controller that no spring of the twin joins, naming the recording.
std::vector<std::string> WarnOfUnjoinedControllers(const Twin& twin, const std::string& recording);

}  // namespace physpring

#endif  // PHYSPRING_CLI_TRAINING_H_
