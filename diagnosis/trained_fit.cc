// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/trained_fit.h"

#include "trainer/fits/dense_fit.h"
#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {

namespace {

// The recordings that have frames to fit, with these frames only. Each counts as one of its own.
FitData DataOf(const std::vector<SplitRecording>& recordings) {
  FitData data;
  for (const SplitRecording& split : recordings) {
    if (split.last(SplitRecording::Use::kFit) == 0) continue;
    data.continuous_recording.push_back(static_cast<int>(data.recordings.size()));
    data.recordings.push_back(OnlyFitFrames(split.All()));
  }
  return data;
}

}  // namespace

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

std::optional<Verdict> TrainAnew(const Fitting& fitting, const WorkShare& share,
                                 const std::vector<EffectValues>& effects) {
  TrainOptions options;
  options.effects = effects;
  options.threads = fitting.threads();
  PieceKey key("training");
  key.Add(effects);
  try {
    const Work work(&fitting.journal(), key, share,
                    "training anew with " + effects.back().name + ": ");
    return JudgeTwin(FitDense(DataOf(fitting.recordings()), options, work), fitting.recordings());
  } catch (const Error&) {
    return {};
  }
}

}  // namespace physpring
