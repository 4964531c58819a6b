// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/trained_fit.h"

#include "trainer/dense_fit.h"
#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {

std::optional<EffectFit> AsTrained(const Twin& twin, const std::vector<SplitRecording>& recordings,
                                   const EffectFit& like) {
  EffectFit fit = like;
  fit.trained = true;
  fit.controller_velocity = twin.controller_velocity;
  fit.system = twin.levels[0].system;
  std::vector<std::vector<Points>> predicted;
  try {
    for (const SplitRecording& split : recordings) {
      predicted.push_back(Predict(twin, 0, *split.recording, {}));
    }
  } catch (const Error&) {
    return {};
  }
  ScorePrediction(recordings, predicted, &fit);
  return fit;
}

std::optional<EffectFit> TrainAnew(const EffectFitting& fitting, const WorkShare& share,
                                   const EffectFit& like) {
  FitData data;
  for (const SplitRecording& split : fitting.recordings()) {
    if (split.last(SplitRecording::Use::kFit) == 0) continue;
    data.continuous_recording.push_back(static_cast<int>(data.recordings.size()));
    data.recordings.push_back(OnlyFitFrames(split.All()));
  }
  TrainOptions options;
  options.effects = like.system.effects;
  options.threads = fitting.threads();
  PieceKey key("training");
  key.Add(options.effects);
  try {
    const Work work(&fitting.journal(), key, share,
                    "training anew with " + options.effects.back().name + ": ");
    return AsTrained(FitDense(data, options, work), fitting.recordings(), like);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace physpring
