// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_JOBS_TRACKING_H_
#define PHYSPRING_JOBS_TRACKING_H_

#include <string>
#include <vector>

#include "tracker/track_recording.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// A recording that was read, as it is tracked: by the twin's clock; where it has clouds alone, the
// twin is placed in the first one (registration/placed_twin.h). Throws Error as that does, and for
// clouds alone that are not to be followed.
Recording RecordingToTrack(const Twin& twin, Recording recording, const TrackOptions& options);

// Empty unless so many springs are softened that the body may be lost.
std::string WarningOfSoftened(double softened);

// A twin that tracks worse than what needs no measurement, or no twin, is of no use; nor is one
// that is not where the cloud is, or hardly the twin any more.
std::vector<std::string> WarningsOf(const TrackedMotion& motion);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_TRACKING_H_
