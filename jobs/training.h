// SPDX-License-Identifier: Apache-2.0
// A training run, with checkpoints, until it is done or asked to stop; and what is to say of it.
#ifndef PHYSPRING_JOBS_TRAINING_H_
#define PHYSPRING_JOBS_TRAINING_H_

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "jobs/checkpoint.h"
#include "jobs/fit_report.h"
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
  Twin twin;             // as written
  FitReport fit;         // of the finished twin
  bool stopped = false;  // it was asked to stop (twin/stop_request.h)
  double share = 0;      // of the work that is done
  std::string status;    // of the last step
  // Where the time went: parts and seconds, in the order of their first step; the last one is
  // writing checkpoints.
  std::vector<std::pair<std::string, double>> parts;
};

// Is told before a step which share (0 to 1) of the work is done, and what was done last. Any
// thread may call it, one at a time.
using TellProgress = std::function<void(double share, const std::string& status)>;

// How good the finished twin of a task is; also warns of controllers and forces that it does not
// use.
FitReport JudgeTraining(const TrainingTask& task, const Twin& twin);

// Writes `checkpoint` at most every `interval` seconds, and at the end. Goes on from it if
// `resume`. The finished twin is judged, and says how well it fits. Each step and checkpoint is a
// line of the log (spdlog's default logger).
TrainingRun RunTraining(const TrainingTask& task, const Checkpoint& checkpoint, bool resume,
                        double interval, const TellProgress& progress);

// Level 0 for another training on `data`. Throws Error, beginning with `path`, unless the twin was
// trained on all of its recordings.
void ExpectLevel0Of(const FitData& data, const Twin& twin, const std::string& path);

// The effects of a twin that was diagnosed. Throws Error if it has none.
std::vector<EffectValues> EffectsOf(const Twin& twin, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_TRAINING_H_
