// SPDX-License-Identifier: Apache-2.0
// Which frames of a recording a diagnosis fits, and which it judges by.
#ifndef PHYSPRING_DIAGNOSIS_SPLIT_RECORDING_H_
#define PHYSPRING_DIAGNOSIS_SPLIT_RECORDING_H_

#include "trainer/data/episode.h"

namespace physpring {

// Holds out the future of a recording (from train_frames on). Where it has none, every fourth block
// is held out; a block is 0.3 s, or a quarter of a shorter recording. The rest is to fit.
SplitRecording HoldOutFrames(const Recording& recording);

// Takes away the use of frames from half a second after everything came to rest, and after half of
// what is held out. These frames show the same again and again, and would outweigh the motion. At
// rest, points and controllers stay where they end, to 2 % of the farthest that they were from
// there, and to twice the measurements' noise [m] (noise_floor.h). Returns how many frames it took.
int LeaveOutRest(double noise, SplitRecording* split);

// The recording with the held-out frames to fit, too.
SplitRecording FitHeldOut(SplitRecording split);

// The recording with the held-out frames of no use.
SplitRecording DropHeldOut(SplitRecording split);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_SPLIT_RECORDING_H_
