// SPDX-License-Identifier: Apache-2.0
// The ranking of the effects that were tried, as bars with intervals (HTML).
#ifndef PHYSPRING_REPORT_DIAGNOSIS_RANKING_BARS_H_
#define PHYSPRING_REPORT_DIAGNOSIS_RANKING_BARS_H_

#include <string>

#include "diagnosis/diagnosis.h"

namespace physpring {

// Bars of the error on held-back frames with one effect each, those of one round of the search,
// and what was not refitted. Empty if nothing was tried.
std::string FormatRanking(const Diagnosis& diagnosis, std::size_t round);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_RANKING_BARS_H_
