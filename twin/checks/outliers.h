// SPDX-License-Identifier: Apache-2.0
// Measurements that no body makes: a track that jumps away from its neighbours, for a frame or for
// good. A measurement is one if the point moved, since it was last where it should be, unlike each
// of its neighbours and unlike its own velocity, by more than the distance between points.
#ifndef PHYSPRING_TWIN_CHECKS_OUTLIERS_H_
#define PHYSPRING_TWIN_CHECKS_OUTLIERS_H_

#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

struct OutlyingTrack {
  int point = 0;
  std::vector<int> frames;  // in which it is off
  double jump = 0;          // m, the distance from where it should have been in the first of them
};

// Of `recording`, whose `start` is set; frame 0 is taken as it is.
std::vector<OutlyingTrack> FindOutliers(const Recording& recording);

// Marks them as not seen. Says so, one line for all, beginning with `where`; empty if there are
// none.
std::string LeaveOutOutliers(const std::string& where, Recording* recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_OUTLIERS_H_
