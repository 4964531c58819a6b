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

#include "registration/register_clouds.h"

namespace physpring {

// `clouds`: a recording whose `surface` are markers. `rod`: they are along a rod. Then they are
// numbered along it, from the end that is nearer to the first controller, and get an `order`.
// Throws Error as RegisterClouds does, and for markers that are no rod.
RegisteredClouds RegisterMarkers(const Recording& clouds, bool rod);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_REGISTER_MARKERS_H_
