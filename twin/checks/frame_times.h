// SPDX-License-Identifier: Apache-2.0
// Whether the frames of a recording follow each other at its rate: frames that are missing, and
// frames that were recorded twice. Both look like forces that are not there.
#ifndef PHYSPRING_TWIN_CHECKS_FRAME_TIMES_H_
#define PHYSPRING_TWIN_CHECKS_FRAME_TIMES_H_

#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// Frames before which one or two are missing: cubic curves through six frames about each fit far
// better if that time is left out. None if there are too few of them to be no chance.
std::vector<int> FramesAfterGaps(const Recording& recording);

// Frames in which every point is exactly where it was in the frame before, while things move before
// and after. None if there are too few of them.
std::vector<int> RepeatedFrames(const Recording& recording);

// What is odd about the times of the frames, in words; empty if nothing is.
std::string OddFrameTimes(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_FRAME_TIMES_H_
