// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "twin/stability.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

// The shortest sub-step, s, of which a frame of each recording takes a whole number.
double ShortestStep(const std::vector<SplitRecording>& recordings, double most_rate) {
  double step = 1 / most_rate;
  for (const SplitRecording& split : recordings) {
    const double fps = split.recording->fps;
    step = std::max(step, 1 / (std::floor(most_rate / fps) * fps));
  }
  return step;
}

SystemMap MapOf(const EffectModel& model, const std::vector<SplitRecording>& recordings,
                const EffectProblem::Options& options) {
  const double timestep = ShortestStep(recordings, options.most_rate) / options.safety;
  return SystemMap::OfResiduals([model, timestep](const Eigen::VectorXd& x) {
    SpringMassSystem system = model.Apply(x);
    LimitDashpots(timestep, &system);
    return system;
  });
}

// Episodes up to the last frame to fit or, without `fit_only`, up to the last one in use.
std::vector<Episode> EpisodesOf(const std::vector<SplitRecording>& recordings, bool fit_only) {
  std::vector<Episode> episodes;
  for (const SplitRecording& split : recordings) {
    const int fit = split.last(Use::kFit);
    const int frames = fit_only ? fit : std::max(fit, split.last(Use::kHeld));
    episodes.push_back(split.First(frames));
  }
  return episodes;
}

}  // namespace

int DiagnosisRate(const SpringMassSystem& system, double fps) {
  const int substeps = StableSubsteps(ComputeStabilityBound(system), 1 / fps, kStepSafety);
  return static_cast<int>(std::ceil(std::max(substeps * fps, kLeastDiagnosisRate)));
}

EffectProblem::Options::Options() {
  most_substeps = std::numeric_limits<int>::max();
  most_rate = 10000;
  keep_substeps = true;
}

EffectProblem::EffectProblem(const EffectModel& model,
                             const std::vector<SplitRecording>& recordings, const Options& options)
    : MotionProblem(MapOf(model, recordings, options), EpisodesOf(recordings, true), options),
      model_(model),
      all_(EpisodesOf(recordings, false), options) {}

std::optional<std::vector<std::vector<Points>>> EffectProblem::Predict(
    const Eigen::VectorXd& x) const {
  const auto motions = all_.Run(SystemAt(x), substeps());
  if (!motions) return {};
  std::vector<std::vector<Points>> predicted;
  for (const LiftedMotion::Motion& motion : *motions) predicted.push_back(motion.particles());
  return predicted;
}

FrameTrack TrackOf(const std::vector<SplitRecording>& recordings,
                   const std::vector<std::vector<Points>>& predicted, Use use) {
  FrameTrack all;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (recordings[i].before_change) continue;
    const FrameTrack track = TrackOf(recordings[i].All(), use, predicted[i]);
    all.insert(all.end(), track.begin(), track.end());
  }
  return all;
}

}  // namespace physpring
