// SPDX-License-Identifier: Apache-2.0
// The state of a twin's object while it is being measured, frame by frame (tracker_bank.h). No
// later frame is needed, and memory does not grow.
#ifndef PHYSPRING_TRACKER_LIVE_TRACKER_H_
#define PHYSPRING_TRACKER_LIVE_TRACKER_H_

#include <vector>

#include "tracker/tracker_bank.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct LiveOptions {
  double fps = 0;       // of the frames
  double noise = 1e-3;  // standard deviation of a measured coordinate, m
  int substeps = 0;     // a frame (tracked_body.h); 0: as many as it takes
};

struct LiveFrame {
  FrameMeasurement measured;  // `named` of the twin's points, or of none; NaN: not seen
  Points controllers;         // 3 x controllers, m
};

class LiveTracker {
 public:
  // Level 0 of the twin, at rest in the first frame. What is not seen there is where the points and
  // controllers around it take it from the twin's reference configuration. Throws Error, as
  // Advance does, for a frame of other numbers of points or controllers than the twin's.
  LiveTracker(const Twin& twin, const LiveOptions& options, const LiveFrame& first);

  // Goes on to the next frame, 1 / fps later. Throws Error if the motion diverges.
  void Advance(const LiveFrame& frame);

  const StateTracker& state() const { return bank_.best(); }

 private:
  void ExpectNumbers(const LiveFrame& frame) const;
  TrackerBank MakeBank(const Twin& twin, const LiveOptions& options, const LiveFrame& first) const;

  int points_, controllers_;
  double fps_, delay_;
  int frame_ = 0;
  Recording lately_;  // the controllers of the last frames, as far back as they act
  TrackerBank bank_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_LIVE_TRACKER_H_
