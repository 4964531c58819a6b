// SPDX-License-Identifier: Apache-2.0
// How good a twin is on the recordings that it was trained on.
#ifndef PHYSPRING_JOBS_FIT_REPORT_H_
#define PHYSPRING_JOBS_FIT_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "twin/evaluate.h"
#include "twin/twin.h"

namespace physpring {

struct FitReport {
  std::optional<FitErrors> errors;  // none where the fit frames have no data
  std::string line;  // the errors on the fit frames and after them; is what is left noise
  std::vector<std::string> warnings;  // a useless twin, and a baseline that is nearer
};

// Of a twin trained on `data` with these options. Throws Error if the twin diverges.
FitReport JudgeFit(const Twin& twin, const FitData& data, const TrainOptions& options);

// A line for each level, and each baseline (twin/baselines.h) that is nearer than it to what was
// measured in frames [first, last) of the recordings, by more than a twentieth. `frames` says which
// these are.
std::vector<std::string> NearerBaselines(const std::vector<RecordingResult>& results,
                                         const std::vector<int>& first,
                                         const std::vector<int>& last, const std::string& frames);

// What TooLittleExplained says of level 0 in frames [first, last) of the recordings; `noisy` is one
// of them.
std::string LittleExplained(const std::vector<RecordingResult>& results,
                            const std::vector<int>& first, const std::vector<int>& last,
                            const Recording& noisy);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_FIT_REPORT_H_
