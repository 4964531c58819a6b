// SPDX-License-Identifier: Apache-2.0
// The search for the effect that a model lacks, together with the body that it belongs to: with
// physics missing, the body that fits best is seldom the right one. Each of the effects that the
// trace ranks first is tried on each body, all are fitted for a few steps, the better part goes on:
// first over a short horizon, then over all fit frames (successive halving).
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trainer/diagnosis/effect_trace.h"

namespace physpring {

// Called between steps with the share that is done; may throw to stop.
using SearchProgress = std::function<void(double share, const std::string& status)>;

// Each body as it is, fitted over the short horizon. Those that diverge are left out.
std::vector<EffectFit> FitBodies(EffectFitting* fitting, const std::vector<EffectValues>& known);

// The best of them on held-out frames after a fit to all fit frames; nothing if all diverge.
std::optional<EffectFit> FitBest(const EffectFitting& fitting, std::vector<EffectFit> bodies);

struct EffectSearchResult {
  std::vector<EffectTrace> traces;  // of each effect, the better of the bodies that were traced
  std::vector<EffectFit> fits;      // of the best effects, judged, least held-out error first
};

// `bodies`: fits without the effect, over the short horizon.
EffectSearchResult SearchEffects(const EffectFitting& fitting, const std::vector<EffectFit>& bodies,
                                 const std::vector<const Effect*>& effects,
                                 const SearchProgress& progress);

// Which of `fits` to take: of those whose held-out error is within one standard error (of the
// paired difference) of the least, the one with the fewest parameters. `block`: frames that are
// drawn together (block_bootstrap.h). `fits` is not empty.
std::size_t ChooseSimplest(const std::vector<EffectFit>& fits, int block, std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_
