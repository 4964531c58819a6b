// SPDX-License-Identifier: Apache-2.0
// Whether an object lies on something that the recording does not tell of.
#ifndef PHYSPRING_TWIN_CHECKS_MISSING_GROUND_H_
#define PHYSPRING_TWIN_CHECKS_MISSING_GROUND_H_

#include <string>

#include "twin/checks/motion_scale.h"
#include "twin/recording.h"

namespace physpring {

// A line for an object without a ground that is flat at the start, is lifted on one side, and is
// never lower than it started: it lay on something. What hangs, or is clamped and swings, gets
// lower. Empty otherwise.
std::string MissingGround(const Recording& recording, const MotionScale& scale);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_MISSING_GROUND_H_
