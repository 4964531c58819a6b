// SPDX-License-Identifier: Apache-2.0
// Verdicts with bodies that are materials (trainer/bodies/smooth_body.h). Common factors cannot make
// a body the true one, and an effect then stands for what they lack; single springs bend to what an
// effect does. A smooth body does neither, so its errors tell effects apart.
#ifndef PHYSPRING_DIAGNOSIS_SMOOTH_REFIT_H_
#define PHYSPRING_DIAGNOSIS_SMOOTH_REFIT_H_

#include <string>
#include <vector>

#include "diagnosis/fitting.h"

namespace physpring {

// Each of the verdicts, from common factors, with its body fitted as a smooth one together with the
// effects' values. `of` says in a few words whose bodies they are. A verdict whose motion diverges
// stays as it is.
std::vector<Verdict> RefitSmoothly(const Fitting& fitting, const WorkShare& stage,
                                   const std::string& of, const std::vector<Verdict>& verdicts);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_SMOOTH_REFIT_H_
