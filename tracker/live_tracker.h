// SPDX-License-Identifier: Apache-2.0
// The state of a twin's object while it is being measured, frame by frame (tracker_bank.h). No
// later frame is needed, and memory does not grow.
#ifndef PHYSPRING_TRACKER_LIVE_TRACKER_H_
#define PHYSPRING_TRACKER_LIVE_TRACKER_H_

#include <optional>
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
  Points controllers;         // 3 x controllers, m; NaN: where it was, of one that does not hold
  std::optional<ControllerMask> held;  // which of them hold; none: as in the last frame
};

class LiveTracker {
 public:
  // Level 0 of the twin, at rest in the first frame. What is not seen there is where the points and
  // controllers around it take it from the twin's reference configuration. Throws Error, as
  // Advance does, for a frame of other numbers of points or controllers than the twin's, and for a
  // controller that holds and is nowhere.
  LiveTracker(const Twin& twin, const LiveOptions& options, const LiveFrame& first);

  // Goes on to the next frame, 1 / fps later. Throws Error if the motion diverges.
  void Advance(const LiveFrame& frame);

  const StateTracker& state() const { return bank_.best(); }
  // The part of the springs that are softened (tracked_body.h).
  double softened() const { return softened_; }

 private:
  // Which controllers hold in the frame. Throws Error where the frame is not of this object.
  ControllerMask HeldIn(const LiveFrame& frame) const;
  // What is released on the way to a frame, and takes hold.
  void SetGrasps(const ControllerMask& held, FrameInput* input);
  TrackerBank MakeBank(const Twin& twin, const LiveOptions& options, const LiveFrame& first);

  int points_, controllers_;
  double fps_, delay_, softened_ = 0;
  int frame_ = 0;
  ControllerMask held_, holding_;  // in the last frame; and in the one before it, too
  Recording lately_;               // the controllers of the last frames, as far back as they act
  TrackerBank bank_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_LIVE_TRACKER_H_
