// SPDX-License-Identifier: Apache-2.0
// Velocities in frame 0 of a recording that starts in motion. A parabola is laid through the first
// frames of each point,
//   x(t) = x_0 + v t + a t^2 / 2,
// over as many frames as it fits to within the noise. The start is in motion if v alone makes most
// of the second step. A start from rest gives v = 0 up to the noise and the change of a. A body
// that may have been let go from rest in frame 0 is taken to be at rest.
#ifndef PHYSPRING_TWIN_CHECKS_START_VELOCITY_H_
#define PHYSPRING_TWIN_CHECKS_START_VELOCITY_H_

#include <optional>

#include "twin/recording.h"

namespace physpring {

struct StartVelocity {
  Points velocity;        // 3 x (N+M), m/s
  int frames = 0;         // 0 to frames - 1 were used
  bool measured = false;  // false: interior particles are too far from what is measured
};

// None where the start is at rest as far as the noise lets tell. `start` of the recording is set.
// What is not seen in these frames, and interior particles, move as their neighbours do.
std::optional<StartVelocity> EstimateStartVelocity(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_START_VELOCITY_H_
