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

#include <vector>

#include "trainer/diagnosis/effect_trace.h"

namespace physpring {

// `stage`, here and below: the share of the work, for the journal.

// The bodies that fit best with the effects that are known, the best first. Those that diverge are
// left out.
struct FittedBodies {
  std::vector<Descent> early;   // under the highest gain; none after an effect was found
  std::vector<Descent> fitted;  // down to the gain of the trace
};
FittedBodies FitBodies(const Fitting& fitting, const std::vector<EffectValues>& known,
                       const WorkShare& stage);

// Fitted without an observer and judged, least held-out error first.
std::vector<Verdict> FitFreely(const Fitting& fitting, const WorkShare& stage,
                               std::vector<Descent> bodies);

struct EffectSearchResult {
  std::vector<EffectTrace> traces;  // of each effect, on the best body
  std::vector<Verdict> verdicts;    // on the best effects, least held-out error first
};

// `bodies`: fits without the effect; at least one that is fitted.
EffectSearchResult SearchEffects(const Fitting& fitting, const FittedBodies& bodies,
                                 const std::vector<const Effect*>& effects, const WorkShare& stage);

// Fitted once more from where it is, under an observer and then without one: what is far from its
// least there may come nearer to it. The same where that fits worse.
Verdict FollowAgain(const Fitting& fitting, const WorkShare& stage, const Verdict& verdict);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_SEARCH_H_
