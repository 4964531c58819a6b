// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_CLI_TRAINING_HINT_H_
#define PHYSPRING_CLI_TRAINING_HINT_H_

#include <string>

#include "trainer/data/train_options.h"

namespace physpring {

// What would make a training with these options shorter, one line, if it is known to be long: after
// `seconds` of work, `seconds_left` seem to be left (below 0: unknown). Else empty.
std::string HintIfLong(const TrainOptions& options, double seconds, double seconds_left);

}  // namespace physpring

#endif  // PHYSPRING_CLI_TRAINING_HINT_H_
