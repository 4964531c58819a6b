// SPDX-License-Identifier: Apache-2.0
// Plots of the forces that a model lacks: on each node, along the body, over time, by frequency,
// and against speed and stretch.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_RESIDUAL_PLOTS_H_
#define PHYSPRING_REPORT_DIAGNOSIS_RESIDUAL_PLOTS_H_

#include <string>

#include "diagnosis/diagnosis.h"
#include "report/picture/view.h"

namespace physpring {

// HTML; `fps` and `view` are the first recording's.
std::string FormatResidualPlots(const Diagnosis& diagnosis, double fps, const View& view);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_RESIDUAL_PLOTS_H_
