// SPDX-License-Identifier: Apache-2.0
// Which of many recordings of an object a diagnosis looks at: what a twin lacks shows in a few of
// them, and each costs as much as the others.
#ifndef PHYSPRING_DIAGNOSIS_DIAGNOSIS_RECORDINGS_H_
#define PHYSPRING_DIAGNOSIS_DIAGNOSIS_RECORDINGS_H_

#include <vector>

#include "trainer/data/fit_data.h"
#include "twin/recording.h"

namespace physpring {

struct DiagnosisRecordings {
  std::vector<Recording> fit = {};
  std::vector<Recording> held_out = {};  // none: frames of those to fit are held out
  // Of the object before it changed. They are fitted, too, without the effects that are looked for.
  std::vector<Recording> before = {};
};

// Without recordings to judge by, whole runs of `data` are held out where it has enough of them
// (HeldBackRuns): a run goes on where the one before it stopped, so parts of it know each other.
// ChooseRecordings takes at most four on each side, and fewer where they are long: a thousand
// frames are enough. The same holds for those from before the change.
DiagnosisRecordings ChooseRecordings(const FitData& data, const std::vector<Recording>& held_out,
                                     const std::vector<Recording>& before = {});

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_DIAGNOSIS_RECORDINGS_H_
