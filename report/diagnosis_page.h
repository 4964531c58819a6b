// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found, as a self-contained page.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_PAGE_H_
#define PHYSPRING_REPORT_DIAGNOSIS_PAGE_H_

#include <string>

#include "trainer/diagnosis/diagnosis.h"

namespace physpring {

// `recording`: the first one.
std::string FormatDiagnosisPage(const Diagnosis& diagnosis, const Recording& recording,
                                const std::string& title);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_PAGE_H_
