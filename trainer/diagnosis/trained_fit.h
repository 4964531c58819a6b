// SPDX-License-Identifier: Apache-2.0
// Fits that come from a training (full_fit.h), which takes more care of single springs than a refit
// in a diagnosis: the twin's own, and one of the same object with the effects that were found.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_TRAINED_FIT_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_TRAINED_FIT_H_

#include <optional>

#include "trainer/diagnosis/effect_fit.h"
#include "twin/twin.h"

namespace physpring {

// The twin as it came; nothing if its motion diverges. The rest as in `like`.
std::optional<EffectFit> AsTrained(const Twin& twin, const std::vector<SplitRecording>& recordings,
                                   const EffectFit& like);

// The training on the frames to fit, as `physpring train --effects` does, of a twin that has the
// effects of `like`; nothing if the motion diverges.
std::optional<EffectFit> TrainAnew(const EffectFitting& fitting, const WorkShare& share,
                                   const EffectFit& like);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_TRAINED_FIT_H_
