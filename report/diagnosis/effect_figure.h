// SPDX-License-Identifier: Apache-2.0
// Drawings of an effect that was found (HTML): where on the body it acts and in which direction,
// and how it varies along the body or in time.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_EFFECT_FIGURE_H_
#define PHYSPRING_REPORT_DIAGNOSIS_EFFECT_FIGURE_H_

#include <string>

#include "diagnosis/diagnosis.h"
#include "report/picture/view.h"

namespace physpring {

// Of the effect with that index.
std::string FormatEffectFigures(const Diagnosis& diagnosis, std::size_t effect, const View& view);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_EFFECT_FIGURE_H_
