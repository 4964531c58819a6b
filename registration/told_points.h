// SPDX-License-Identifier: Apache-2.0
// What clouds tell of points whose places are about known: each is where the points of the cloud
// near it are, on average. Where there are none it is not seen.
#ifndef PHYSPRING_REGISTRATION_TOLD_POINTS_H_
#define PHYSPRING_REGISTRATION_TOLD_POINTS_H_

#include <optional>
#include <vector>

#include "tracker/track_recording.h"
#include "twin/recording.h"

namespace physpring {

// Frames from the first to the last one.
struct FrameSpan {
  int first, last;
  bool operator==(const FrameSpan&) const = default;
};

struct RegisteredClouds {
  // The clouds' recording with `points`, NaN where no point of the cloud tells of one.
  Recording recording;
  double seen = 0;      // the part of all points in all frames after frame 0 that clouds tell of
  CloudFit fit;         // of the points where they are followed to
  double distance = 0;  // as fit.distance, mean of all frames with a cloud, m; NaN without
  // Where the body is lost, if it is: clouds mostly are not where the points are, or tell of
  // hardly any of them.
  std::optional<FrameSpan> lost;
  int outliers = 0;  // points of the first cloud that were left out
};

// The recording with the points that its clouds tell of particles at `position`, T frames of 3 x
// particles, m; in frame 0 they are as they were.
RegisteredClouds TellPoints(const Recording& recording, const std::vector<Points>& position);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_TOLD_POINTS_H_
