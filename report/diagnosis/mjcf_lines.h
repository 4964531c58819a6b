// SPDX-License-Identifier: Apache-2.0
// How a MuJoCo model carries an effect: the lines of MJCF that it adds or changes.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_MJCF_LINES_H_
#define PHYSPRING_REPORT_DIAGNOSIS_MJCF_LINES_H_

#include <string>

#include "twin/twin.h"

namespace physpring {

// HTML: a sentence, and the first lines of many.
std::string FormatMjcfLines(const EffectValues& effect, const Twin& twin);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_MJCF_LINES_H_
