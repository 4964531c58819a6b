// SPDX-License-Identifier: Apache-2.0
// A twin judged on recordings of its object, as people ask for it.
#ifndef PHYSPRING_JOBS_EVALUATION_H_
#define PHYSPRING_JOBS_EVALUATION_H_

#include <string>
#include <vector>

#include "report/evaluation.h"
#include "twin/baselines.h"
#include "twin/dataset.h"
#include "twin/predict.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct EvaluationOptions {
  PredictOptions predict;
  int anchor = 0;  // also predict anew from this frame on, as tracked there; 0: no
  std::vector<Baseline> others = {};  // predictions of other methods, of the one recording
};

// Throws Error unless the prediction of another method may be called so: a plain name that means
// nothing else in the report.
void ExpectPredictionName(const std::string& name);

// The prediction of another method: array `particles` (T, N + M, 3) in m, for all frames of the
// recording. Throws Error, one line that begins with the path.
Baseline ReadPrediction(const std::string& name, const std::string& path,
                        const Recording& recording);

// A recording by the twin's clock, from `entry`. Its remarks are in the result's recording.
EvaluatedRecording EvaluateRecording(const Twin& twin, const RecordingEntry& entry,
                                     Recording recording, const EvaluationOptions& options);

// What a user must know of the whole: a twin that explains little, and baselines that are nearer.
std::vector<std::string> WarningsOf(const Evaluation& evaluation);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_EVALUATION_H_
