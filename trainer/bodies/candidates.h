// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_BODIES_CANDIDATES_H_
#define PHYSPRING_TRAINER_BODIES_CANDIDATES_H_

#include <vector>

#include "trainer/bodies/body.h"
#include "trainer/data/train_options.h"

namespace physpring {

// The bodies that the options leave open, in all combinations, few neighbours first. For a rod
// whose neighbours are not given, a chain that bends comes last; if it has branches, alone. The
// list is never empty.
std::vector<Body> CandidateBodies(const Recording& recording, const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_CANDIDATES_H_
