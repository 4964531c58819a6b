// SPDX-License-Identifier: Apache-2.0
// Verdicts on trainings (dense_fit.h), which take more care of single springs than a refit in a
// diagnosis: the twin's own, and one of the same object with the effects that were found.
#ifndef PHYSPRING_DIAGNOSIS_TRAINED_FIT_H_
#define PHYSPRING_DIAGNOSIS_TRAINED_FIT_H_

#include <optional>

#include "diagnosis/fitting.h"
#include "twin/twin.h"

namespace physpring {

// The verdict on the twin as it came; nothing if its motion diverges.
std::optional<Verdict> JudgeTwin(const Twin& twin, const std::vector<SplitRecording>& recordings);

// The verdict on a training on the frames to fit, as `physpring train --effects` does, of a twin
// that has these effects, at least one; nothing if the motion diverges.
std::optional<Verdict> TrainAnew(const Fitting& fitting, const WorkShare& share,
                                 const std::vector<EffectValues>& effects);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_TRAINED_FIT_H_
