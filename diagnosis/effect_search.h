// SPDX-License-Identifier: Apache-2.0
// The search for the effect that a model lacks, together with the body that it belongs to, under an
// observer whose gain falls (observer.h): with a high gain the misfit is the body's, since what is
// missing has no time to add up; with a low one it is the effect's. So bodies are chosen first.
//
// Bodies are smooth ones (trainer/bodies/smooth_body.h). Common factors cannot make a body the true
// one, and an effect then stands for what they lack; single springs bend to what an effect does.
//
// A body that is fitted further without what it lacks bends to make up for it. A block whose
// springs yield becomes one of high damping, and no step with the effect leads back from there. So
// effects that a trace ranks first are tried on bodies of common factors that were fitted under the
// highest gain only, and on the smooth body fitted further. One linear step says little of laws of
// the springs, so these are also tried by two steps from each of their starts. From there on all go
// down together as smooth bodies, the better part at a time (successive halving).
#ifndef PHYSPRING_DIAGNOSIS_EFFECT_SEARCH_H_
#define PHYSPRING_DIAGNOSIS_EFFECT_SEARCH_H_

#include <limits>
#include <optional>
#include <vector>

#include "diagnosis/effect_trace.h"

namespace physpring {

// `stage`, here and below: the share of the work, for the journal.

// Fits without the effect, to which effects are added.
struct FittedBodies {
  // With common factors, under the highest gain only, the best first; none after an effect was
  // found.
  std::vector<Descent> early;
  // The best one down to the gain of the trace: a smooth one, unless it hardly moves.
  Descent fitted;
};

// The body as it was trained, down to the gain of the trace; nothing if there is no such body or it
// diverges.
std::optional<Descent> FitTrained(const Fitting& fitting, const std::vector<EffectValues>& known,
                                  const WorkShare& stage);

// The bodies that fit best with the effects that are known; the trained one is among those that
// `fitted` is chosen from. Nothing if all diverge.
std::optional<FittedBodies> FitBodies(const Fitting& fitting,
                                      const std::vector<EffectValues>& known,
                                      const std::optional<Descent>& trained,
                                      const WorkShare& stage);

// The body, fitted without an observer and judged; nothing if it diverges.
std::optional<Verdict> FitFreely(const Fitting& fitting, const WorkShare& stage,
                                 const Descent& body);

struct EffectSearchResult {
  std::vector<EffectTrace> traces;  // one for each effect, on the best body
  std::vector<Verdict> verdicts;    // those on the best effects, least held-out error first
};

EffectSearchResult SearchEffects(const Fitting& fitting, const FittedBodies& bodies,
                                 const std::vector<const Effect*>& effects, const WorkShare& stage);

// The descent, fitted once more from where it is, under an observer and then without one: a smooth
// body with all its numbers. A body that hardly moves may come nearer to its least in this way.
// Nothing if the motion diverges, or if the fit is hopeless beside one of that misfit.
std::optional<Verdict> Refine(const Fitting& fitting, const WorkShare& stage,
                              const Descent& descent,
                              double least_misfit = std::numeric_limits<double>::infinity());

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_EFFECT_SEARCH_H_
