// SPDX-License-Identifier: Apache-2.0
// Markers without names -> points that are followed. Unlike a cloud, which shows other points in
// each frame, markers are always the same places of the object: each is one point of a frame, or
// none where it is hidden.
//
// The markers of frame 0 are followed: each is expected to go on as it went in the frame before,
// and the points of a frame are named by that (name_markers.h). One that is hidden goes along with
// those around it. Points without a name in the first third of a second are carried back to frame
// 0. Where they gather there is a marker that frame 0 did not show; what is hardly ever seen again
// was none. Then all are followed again, until the markers stay.
#ifndef PHYSPRING_REGISTRATION_REGISTER_MARKERS_H_
#define PHYSPRING_REGISTRATION_REGISTER_MARKERS_H_

#include <optional>

#include "twin/recording.h"

namespace physpring {

struct RegisteredMarkers {
  Recording recording;      // the clouds' recording with `points`, NaN where a marker is not found
  double seen = 0;          // the part of all markers in all frames after frame 0 that are found
  double distance = 0;      // mean of what is found from where it was expected, m
  double spacing = 0;       // of the markers, m
  double without_name = 0;  // points of a frame that are none of the markers, on the average
  // The frame from which on, to the end, more than half of the markers are not found.
  std::optional<int> lost_from;
  // The part of the markers that are not found in frames that have points without a name instead.
  // Where it is large, markers may have each other's names.
  double confused = 0;
};

// `clouds`: a recording whose `surface` are markers. `rod`: they are along a rod. Then they are
// numbered along it, from the end that is nearer to the first controller, and get an `order`, if
// they are not lost. Throws Error where frame 0 shows too few, and for markers that are no rod.
RegisteredMarkers RegisterMarkers(const Recording& clouds, bool rod);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_REGISTER_MARKERS_H_
