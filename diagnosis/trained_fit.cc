// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/trained_fit.h"

#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {

std::optional<Verdict> JudgeTwin(const Twin& twin, const std::vector<SplitRecording>& recordings) {
  Verdict verdict;
  verdict.provenance = Verdict::Provenance::kTraining;
  verdict.controller_velocity = twin.controller_velocity;
  verdict.system = twin.levels[0].system;
  std::vector<std::vector<Points>> predicted;
  try {
    for (const SplitRecording& split : recordings) {
      predicted.push_back(Predict(twin, 0, *split.recording, {}));
    }
  } catch (const Error&) {
    return {};
  }
  ScorePrediction(recordings, predicted, &verdict);
  return verdict;
}

}  // namespace physpring
