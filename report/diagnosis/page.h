// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found, as one HTML page that needs nothing else: the answer, a film without and
// with the effects, each effect with its values, drawings and lines of MJCF, all explanations that
// were tried, and the forces that are missing.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_PAGE_H_
#define PHYSPRING_REPORT_DIAGNOSIS_PAGE_H_

#include <string>

#include "diagnosis/diagnosis.h"
#include "diagnosis/diagnosis_recordings.h"

namespace physpring {

// `recordings`: those that the diagnosis is of.
std::string FormatDiagnosisPage(const Diagnosis& diagnosis, const DiagnosisRecordings& recordings,
                                const std::string& title);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_PAGE_H_
