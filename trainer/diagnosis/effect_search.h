// SPDX-License-Identifier: Apache-2.0
// The search for the effect that a model lacks, together with the body that it belongs to, under an
// observer whose gain falls (observer.h): with a high gain the misfit is the body's, since what is
// missing has no time to add up; with a low one it is the effect's. So bodies are chosen first.
//
// A body fitted on without what it lacks bends to make up for it: a block whose springs yield
// becomes one of high damping, and no step with the effect leads back from there. So effects are
// tried twice: from the start on, on bodies fitted under the highest gain only, from where a trace
// says (laws of the springs, of which one linear step says little, also by two steps from each of
// their starts); and those that a trace ranks first on the bodies fitted on. From the gain of that
// trace on all go down together, the better part at a time (successive halving).
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_

#include <cstdint>
#include <string>
#include <vector>

#include "trainer/diagnosis/effect_trace.h"

namespace physpring {

// `stage`, here and below: the share of the work, for the journal.

// The bodies that fit best with the effects that are known, the best first. Those that diverge are
// left out.
struct FittedBodies {
  std::vector<EffectFit> early;   // under the highest gain; none after an effect was found
  std::vector<EffectFit> fitted;  // down to the gain of the trace
};
FittedBodies FitBodies(const EffectFitting& fitting, const std::vector<EffectValues>& known,
                       const WorkShare& stage);

// Fits them without an observer and judges them, least held-out error first.
void FitFreely(const EffectFitting& fitting, const WorkShare& stage,
               std::vector<EffectFit>* bodies);

struct EffectSearchResult {
  std::vector<EffectTrace> traces;  // of each effect, on the best body
  std::vector<EffectFit> fits;      // of the best effects, judged, least held-out error first
};

// `bodies`: fits without the effect; at least one that is fitted.
EffectSearchResult SearchEffects(const EffectFitting& fitting, const FittedBodies& bodies,
                                 const std::vector<const Effect*>& effects, const WorkShare& stage);

// Fits it once more from where it is, under an observer and then without one: what is far from its
// least there may come nearer to it. It stays as it is where that fits worse.
void FollowAgain(const EffectFitting& fitting, const WorkShare& stage, EffectFit* fit);

// Whether the fit's new effect has so many parameters that it takes the shape of others. It does
// not compete with them.
bool IsFreeForm(const EffectFit& fit);
bool HasFreeForm(const Effect& effect);

// Which of `fits` to take: of those whose held-out error is within one standard error (of the
// paired difference) of the least, the one with the fewest parameters. `block`: frames that are
// drawn together (block_bootstrap.h). `fits` is not empty.
std::size_t ChooseSimplest(const std::vector<EffectFit>& fits, int block, std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_
