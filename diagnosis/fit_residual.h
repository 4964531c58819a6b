// SPDX-License-Identifier: Apache-2.0
// The residual forces of verdicts' systems, on the first recording.
#ifndef PHYSPRING_DIAGNOSIS_FIT_RESIDUAL_H_
#define PHYSPRING_DIAGNOSIS_FIT_RESIDUAL_H_

#include <vector>

#include "diagnosis/fitting.h"
#include "diagnosis/residual_pattern.h"

namespace physpring {

// The patterns of the forces, one for each verdict. `deviation` is the standard deviation of a
// measured coordinate, m.
std::vector<ResidualPattern> ResidualsOf(const Fitting& fitting,
                                         const std::vector<const Verdict*>& verdicts,
                                         double deviation, const WorkShare& share);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_FIT_RESIDUAL_H_
