// SPDX-License-Identifier: Apache-2.0
// The recordings that a twin was trained on, where they are still there: a twin names them, and
// knows them by their hash.
#ifndef PHYSPRING_JOBS_TRAINING_RECORDINGS_H_
#define PHYSPRING_JOBS_TRAINING_RECORDINGS_H_

#include <string>
#include <vector>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// Those that lie in the folder of one of `files`, or in one that is a folder, in the twin's order.
// A file of the same name and another content is none of them.
std::vector<Recording> FindTrainingRecordings(const Twin& twin,
                                              const std::vector<std::string>& files);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_TRAINING_RECORDINGS_H_
