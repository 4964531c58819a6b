// SPDX-License-Identifier: Apache-2.0
// Predictions judged by pictures: splats move with each of them, and what cameras then see is
// compared with what they recorded.
#ifndef PHYSPRING_JOBS_IMAGE_EVALUATION_H_
#define PHYSPRING_JOBS_IMAGE_EVALUATION_H_

#include <functional>
#include <string>
#include <vector>

#include "report/evaluation.h"

namespace physpring {

struct ImageOptions {
  std::string pictures;              // folder of the recording's
  std::string splats;                // file: the object as in frame 0 of the recording
  std::vector<std::string> cameras;  // of the folder; empty: all
  int threads = 1;
  std::function<void(double part)> progress = {};
};

// Of all rows of `evaluated` and all its frames but frame 0. Adds to its recording's warnings what
// is to be known of where the splats are. Throws Error, one line that begins with the file, where
// pictures are missing, damaged or of other frames than the recording's; Stopped where that is
// asked for.
ImageEvaluation EvaluateImages(const ImageOptions& options, EvaluatedRecording* evaluated);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_IMAGE_EVALUATION_H_
