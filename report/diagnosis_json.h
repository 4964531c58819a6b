// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found, for programs: report.json (docs/diagnose.md).
#ifndef PHYSPRING_REPORT_DIAGNOSIS_JSON_H_
#define PHYSPRING_REPORT_DIAGNOSIS_JSON_H_

#include <string>

#include "diagnosis/diagnosis.h"

namespace physpring {

std::string FormatDiagnosisJson(const Diagnosis& diagnosis);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_JSON_H_
