// SPDX-License-Identifier: Apache-2.0
// Clouds of points without names -> a recording whose points are particles that are followed.
//
// Nothing is known of the body at first. So particles are spread over the first cloud and followed
// (followed_body.h). Then the clouds of the first frames are carried back to frame 0, where
// together they show the shape with less noise and fewer gaps. Particles are spread anew over that,
// and followed again. If the shape is known, or another recording of the object has points, the
// particles are of that.
#ifndef PHYSPRING_REGISTRATION_REGISTER_CLOUDS_H_
#define PHYSPRING_REGISTRATION_REGISTER_CLOUDS_H_

#include "registration/told_points.h"
#include "twin/recording.h"

namespace physpring {

// Made at most where nobody says how many.
inline constexpr int kMostMadePoints = 400;

// Throw Error unless frame 0 of the clouds shows as many points as `fewest`, or `points` are so
// many.
void ExpectSeen(const Recording& clouds, int fewest);
void ExpectEnough(const Recording& clouds, int points, int fewest);

// `clouds`: a recording with `surface`. `points`: how many to make; 0: half as many again as a
// cloud has, 400 at most. Throws Error where frame 0 shows too little for a body, and where the
// body diverges. The result does not depend on the number of threads.
RegisteredClouds RegisterClouds(const Recording& clouds, int points, int threads = 1);

// The same where the shape is known: `surface` are points all over the object as it is in frame 0,
// 3 x any number, m. The particles are spread over them, also where no cloud shows any; 0: three
// times as many as a cloud has.
RegisteredClouds RegisterCloudsOn(const Recording& clouds, const Points& surface, int points,
                                  int threads = 1);

// The same with the points of `known`, another recording of the object, and its interior particles.
RegisteredClouds RegisterCloudsLike(const Recording& clouds, const Recording& known,
                                    int threads = 1);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_REGISTER_CLOUDS_H_
