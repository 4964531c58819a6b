// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found, in one sentence that needs no other, and what speaks against it.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_ANSWER_H_
#define PHYSPRING_REPORT_DIAGNOSIS_ANSWER_H_

#include <string>

#include "diagnosis/diagnosis.h"

namespace physpring {

// "The twin lacks an extra mass of about 12 g ..." or "Nothing is missing: ...".
std::string FormatAnswer(const Diagnosis& diagnosis);

// Values at a bound, other effects that explain the recordings as well, what is left: HTML, empty
// if there is nothing to say.
std::string FormatDoubts(const Diagnosis& diagnosis);

// Which effects and values the recordings cannot tell apart, and why: HTML.
std::string FormatConfounding(const Diagnosis& diagnosis);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_ANSWER_H_
