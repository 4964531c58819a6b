// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found: as JSON for programs (docs/diagnose.md), as lines for a terminal, and as
// a self-contained page.
#ifndef PHYSPRING_CLI_DIAGNOSIS_REPORT_H_
#define PHYSPRING_CLI_DIAGNOSIS_REPORT_H_

#include <string>

#include "trainer/diagnosis/diagnosis.h"

namespace physpring {

std::string FormatDiagnosisJson(const Diagnosis& diagnosis);
std::string FormatDiagnosisText(const Diagnosis& diagnosis);
// `recording`: the first one.
std::string FormatDiagnosisPage(const Diagnosis& diagnosis, const Recording& recording,
                                const std::string& title);

}  // namespace physpring

#endif  // PHYSPRING_CLI_DIAGNOSIS_REPORT_H_
