// SPDX-License-Identifier: Apache-2.0
// The body that trackers move: a twin's level, in as few sub-steps as it bears. A tracker is put
// right in each frame, so it may go closer to the bound of stability than a rollout.
#ifndef PHYSPRING_TRACKER_TRACKED_BODY_H_
#define PHYSPRING_TRACKER_TRACKED_BODY_H_

#include "twin/spring_mass_system.h"

namespace physpring {

struct TrackedBody {
  SpringMassSystem system;
  int substeps;         // a frame
  double softened = 0;  // the part of the springs that are
};

// With more of its springs softened than this, a body may be lost.
inline constexpr double kMostSoftened = 2.0 / 3;

// `substeps`: a frame, 0: as many as it takes. Fewer than it takes soften the stiffest nodes
// (stability.h); effects may then still ask for more of them.
TrackedBody BodyToTrack(const SpringMassSystem& system, double fps, int substeps);

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_TRACKED_BODY_H_
