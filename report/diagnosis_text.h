// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found, in words: lines for a terminal, and sentences that the page shows as
// well.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_TEXT_H_
#define PHYSPRING_REPORT_DIAGNOSIS_TEXT_H_

#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"

namespace physpring {

std::string FormatDiagnosisText(const Diagnosis& diagnosis);

// The effects that the held-out frames cannot tell from the first one accepted, and their names.
std::vector<const EffectCandidate*> ConfoundedCandidates(const Diagnosis& diagnosis);
std::vector<std::string> Confounded(const Diagnosis& diagnosis);

std::string InMillimetres(double metres);                    // "1.20 mm", or "no data"
std::string DescribeVerdict(const Diagnosis& diagnosis);     // "the model lacks air_drag"
std::string DescribeRecordings(const Diagnosis& diagnosis);  // "fitted to a; judged by b"
std::string DescribeGain(const BootstrapResult& gain);       // the gain and its 95 % interval
std::string DescribeCertainty(const Diagnosis& diagnosis);   // what "+-" means
std::string DescribeConfounded(const Diagnosis& diagnosis);  // empty if nothing is confounded
std::string DescribeResidual(const Diagnosis& diagnosis);    // "missing force on a node: ..."
// The parameters of the effect with that index: "mass_kg 0.052 +- 0.001, place_x_m 0.1 +- 0.003,
// ..."
std::string DescribeParameters(const Diagnosis& diagnosis, std::size_t effect);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_TEXT_H_
