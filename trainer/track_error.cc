// SPDX-License-Identifier: Apache-2.0
#include "trainer/track_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/lifted_motion.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kLeastError = 1e-9;  // m

}  // namespace

double GeometricTrackError(const SpringMassSystem& system,
                           const std::vector<JudgedEpisode>& episodes, RolloutOptions options) {
  const bool automatic = options.substeps == 0;
  const StabilityBound bound = automatic ? ComputeStabilityBound(system) : StabilityBound{};
  double sum = 0;  // of logarithms
  for (const JudgedEpisode& judged : episodes) {
    const Episode& episode = judged.episode;
    if (automatic) {
      options.substeps = StableSubsteps(bound, 1 / episode.recording->fps, kStepSafety);
    }
    const auto rollout = RollOut(system, episode, options);
    if (rollout->diverged()) return std::numeric_limits<double>::infinity();
    const auto error = MeanTrackError(rollout->positions(), *judged.seen, 1, episode.frames);
    sum += std::log(std::max(error.value_or(0), kLeastError));
  }
  return std::exp(sum / static_cast<double>(episodes.size()));
}

}  // namespace physpring
