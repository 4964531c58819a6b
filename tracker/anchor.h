// SPDX-License-Identifier: Apache-2.0
// A recording that begins anew in a later frame, from the state in which a twin's object is there.
#ifndef PHYSPRING_TRACKER_ANCHOR_H_
#define PHYSPRING_TRACKER_ANCHOR_H_

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// The frames of `recording` from `frame` on. It starts where the twin's particles are tracked to be
// (track_recording.h) by what is seen up to that frame, and as fast. It has no hash: no twin was
// trained on it. Throws Error unless the twin's object is seen in two frames or more after `frame`
// >= 1, for grasps that begin or end, and as TrackRecording does.
Recording AnchoredAt(int frame, const Twin& twin, const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_ANCHOR_H_
