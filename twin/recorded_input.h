// SPDX-License-Identifier: Apache-2.0
// The input of a frame of a recording: how the recorded controllers move in it, later than recorded
// by the delay (earlier, if it is negative) that the system's effects ask for
// (twin/effects/control_latency.cc).
#ifndef PHYSPRING_TWIN_RECORDED_INPUT_H_
#define PHYSPRING_TWIN_RECORDED_INPUT_H_

#include <vector>

#include "twin/recording.h"
#include "twin/simulator.h"

namespace physpring {

// The input on the way from frame - 1 to `frame` (>= 1). Controllers are linear between frames and
// stand still before frame 0 and after the last one. A controller that does not hold in both frames
// is released; one that does, but not in the frame before, takes hold of the measured shape.
FrameInput RecordedInput(const Recording& recording, int frame, double delay);

// Adjoint of RecordedInput with respect to the controllers: adds to `controllers_bar`, T frames of
// 3 x controllers, given those of the input's controllers_start and controllers_end.
void RecordedInputAdjoint(const Recording& recording, int frame, double delay,
                          const Points& start_bar, const Points& end_bar,
                          std::vector<Points>* controllers_bar);

// The controllers that take hold within the recording (SimulationOptions::late).
ControllerMask LateGraspsOf(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_RECORDED_INPUT_H_
