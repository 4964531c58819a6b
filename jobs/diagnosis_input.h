// SPDX-License-Identifier: Apache-2.0
// The recordings of a diagnosis as people give them, checked; and what is to say of its result.
#ifndef PHYSPRING_JOBS_DIAGNOSIS_INPUT_H_
#define PHYSPRING_JOBS_DIAGNOSIS_INPUT_H_

#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "diagnosis/diagnosis_recordings.h"
#include "trainer/data/fit_data.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct DiagnosisInput {
  FitData data;                   // to fit
  std::vector<Recording> judged;  // to judge by; none: some of `data` are held out
  std::vector<Recording> before;  // of the object before it changed
  std::vector<std::string> judged_paths, before_paths;  // where they come from, for messages
};

// Throws Error if a recording to judge by, or from before the change, is among the others, too.
void ExpectApart(const DiagnosisInput& input);

// Whether the recordings that a twin was trained on may be of its object before it changed: the
// twin has no effects yet, and none of them is diagnosed.
bool MayBeFromBefore(const Twin& twin, const DiagnosisInput& input);

// Adds the warnings of single recordings, and takes those to look at. Throws Error for one with
// grasps that begin or end, which cannot be diagnosed yet.
DiagnosisRecordings CheckAndChoose(const Twin& twin, DiagnosisInput* input);

// What a user must know before: recordings that declare another mass than the twin has.
std::vector<std::string> WarningsOf(const Twin& twin, const DiagnosisRecordings& recordings);

// And after: a twin that is of no use, and coarse levels that are not fitted.
std::vector<std::string> WarningsOf(const Diagnosis& diagnosis);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_DIAGNOSIS_INPUT_H_
