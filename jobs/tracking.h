// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_JOBS_TRACKING_H_
#define PHYSPRING_JOBS_TRACKING_H_

#include <string>
#include <vector>

#include "tracker/track_recording.h"

namespace physpring {

// A twin that tracks worse than what needs no measurement, or no twin, is of no use; nor is one
// that is not where the cloud is.
std::vector<std::string> WarningsOf(const TrackedMotion& motion);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_TRACKING_H_
