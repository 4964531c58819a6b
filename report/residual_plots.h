// SPDX-License-Identifier: Apache-2.0
// The forces that a diagnosed model lacks, before (red) and after (blue), as pictures (SVG).
#ifndef PHYSPRING_REPORT_RESIDUAL_PLOTS_H_
#define PHYSPRING_REPORT_RESIDUAL_PLOTS_H_

#include <string>

#include "trainer/diagnosis/diagnosis.h"

namespace physpring {

// Of curves, here and elsewhere on the page.
inline constexpr char kBeforeColour[] = "#c33", kAfterColour[] = "#25c";

// The mean force on each node as an arrow, and plots of the force along the body, over time, by
// frequency, in direction, against the speed and against the stretch. `recording`: the one they
// were found on.
std::string FormatResidualPlots(const Diagnosis& diagnosis, const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_RESIDUAL_PLOTS_H_
