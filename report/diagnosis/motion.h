// SPDX-License-Identifier: Apache-2.0
// The motions that a diagnosis predicts without and with the effects that it found, over what was
// measured: as a film, and their error over time.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_MOTION_H_
#define PHYSPRING_REPORT_DIAGNOSIS_MOTION_H_

#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "diagnosis/diagnosis_recordings.h"

namespace physpring {

// A recording as predicted; it and the diagnosis must outlive this.
struct ShownMotion {
  const Recording* recording;
  const std::vector<FrameUse>* uses;
  std::vector<Points> before, after;              // T frames of 3 x nodes, m; after: may be empty
  std::vector<double> before_error, after_error;  // track error, m; NaN without data
};

// At most two recordings that judged and two that were fitted, in this order. One that cannot be
// predicted is left out.
std::vector<ShownMotion> PredictMotions(const Diagnosis& diagnosis,
                                        const DiagnosisRecordings& recordings);

std::string FormatMotionFilm(const Diagnosis& diagnosis, const std::vector<ShownMotion>& motions);
// What goes into the script.
std::string FormatMotionData(const Diagnosis& diagnosis, const std::vector<ShownMotion>& motions);
// The error over time of each motion.
std::string FormatMotionErrors(const Diagnosis& diagnosis, const std::vector<ShownMotion>& motions);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_MOTION_H_
