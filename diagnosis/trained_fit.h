// SPDX-License-Identifier: Apache-2.0
// The verdict on a twin's own training, which may have taken more care than a refit.
#ifndef PHYSPRING_DIAGNOSIS_TRAINED_FIT_H_
#define PHYSPRING_DIAGNOSIS_TRAINED_FIT_H_

#include <optional>

#include "diagnosis/fitting.h"
#include "twin/twin.h"

namespace physpring {

// The verdict on the twin as it came; nothing if its motion diverges.
std::optional<Verdict> JudgeTwin(const Twin& twin, const std::vector<SplitRecording>& recordings);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_TRAINED_FIT_H_
