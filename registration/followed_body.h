// SPDX-License-Identifier: Apache-2.0
// A body of which nothing is known but its particles: soft springs join them, as those that a
// training begins with (trainer/bodies/start_system.h). Its controllers and the clouds pull it
// along (tracker/tracker_bank.h).
#ifndef PHYSPRING_REGISTRATION_FOLLOWED_BODY_H_
#define PHYSPRING_REGISTRATION_FOLLOWED_BODY_H_

#include <vector>

#include "twin/recording.h"

namespace physpring {

// The clouds' recording with particles that are known in frame 0 alone, and at rest there. `start`:
// 3 x particles, m, of which the last ones are `interior`. `rest`: stress-free positions, 3 x
// (particles + controllers), m.
Recording WithParticles(const Recording& clouds, const Points& start, const Points& rest,
                        int interior = 0);

// The same where that is the stress-free shape.
Recording AtRestInFrame0(const Recording& clouds, const Points& start);

// How near a particle a point of a cloud is its own, m: 0.4 times the particles' distance, and not
// less than a two-hundredth of the body's size, since clouds have noise.
double MatchWidth(const Points& start);

// A cloud that is so many of these widths from the particles is not where they are.
inline constexpr double kLostWidths = 2.5;

// Where the particles of such a recording are in all frames: T frames of 3 x particles, m. Throws
// Error where they make no body (twin/topology.h), and where the motion diverges. The result does
// not depend on the number of threads.
std::vector<Points> FollowClouds(const Recording& recording, int threads = 1);

// The particles of another recording of the object, where they are in frame 0 of the clouds: moved
// there as a rigid body with the controllers, then within a second with the controllers and the
// first cloud. What the cloud does not show stays, if the known shape is near the one there. 3 x
// particles, m, interior ones included. Throws Error as FollowClouds does, where the numbers of
// controllers differ, and where the first cloud is not where that has brought them.
Points CarryOver(const Recording& known, const Recording& clouds, int threads = 1);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_FOLLOWED_BODY_H_
