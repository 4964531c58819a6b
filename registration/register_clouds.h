// SPDX-License-Identifier: Apache-2.0
// Clouds of points without names -> a recording whose points are particles that are followed.
//
// Nothing is known of the body at first. So particles are spread over the first cloud and followed
// (followed_body.h). Then the clouds of the first frames are carried back to frame 0, where
// together they show the shape with less noise and fewer gaps. Particles are spread anew over that,
// and followed again. If another recording of the object has points, they are the particles.
#ifndef PHYSPRING_REGISTRATION_REGISTER_CLOUDS_H_
#define PHYSPRING_REGISTRATION_REGISTER_CLOUDS_H_

#include "tracker/track_recording.h"
#include "twin/recording.h"

namespace physpring {

struct RegisteredClouds {
  // The clouds' recording with `points`, NaN where no point of the cloud tells of one.
  Recording recording;
  double seen = 0;    // the part of all points in all frames after frame 0 that clouds tell of
  CloudFit fit;       // of the points where they are followed to
  bool lost = false;  // the clouds are not where the points are, or tell of hardly any
  int outliers = 0;   // points of the first cloud that were left out
};

// Throw Error unless frame 0 of the clouds shows as many points as `fewest`, or `points` are so
// many.
void ExpectSeen(const Recording& clouds, int fewest);
void ExpectEnough(const Recording& clouds, int points, int fewest);

// `clouds`: a recording with `surface`. `points`: how many to make; 0: half as many again as a
// cloud has, 400 at most. Throws Error where frame 0 shows too little for a body, and where the
// body diverges.
RegisteredClouds RegisterClouds(const Recording& clouds, int points);

// The same with the points of `known`, another recording of the object without interior particles.
RegisteredClouds RegisterCloudsLike(const Recording& clouds, const Recording& known);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_REGISTER_CLOUDS_H_
