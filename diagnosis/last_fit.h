// SPDX-License-Identifier: Apache-2.0
// The fit that a diagnosis ends with, once everything is chosen and judged.
#ifndef PHYSPRING_DIAGNOSIS_LAST_FIT_H_
#define PHYSPRING_DIAGNOSIS_LAST_FIT_H_

#include <optional>

#include "diagnosis/fitting.h"

namespace physpring {

// Fits the effects of the chosen verdict and the body, from where they are, by Levenberg-Marquardt
// on all frames, the held-out ones included: a smooth body with all its numbers, or else the common
// factors. `track.fit` is over all of them, and nothing is left to judge by. Returns nothing if the
// motion diverges.
std::optional<Verdict> FitAllFrames(const Fitting& fitting, const WorkShare& share,
                                    const Verdict& chosen);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_LAST_FIT_H_
