// SPDX-License-Identifier: Apache-2.0
// A short rope that hangs from a hand and is swung: small enough to be fitted in a test.
#ifndef PHYSPRING_TESTS_SUPPORT_SWUNG_ROPE_H_
#define PHYSPRING_TESTS_SUPPORT_SWUNG_ROPE_H_

#include "twin/recording.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// A rope of `particles` points 10 mm apart under one controller that moves to and fro, `frames`
// frames at 50 fps, all of them for fitting. The points are where they start in every frame.
Recording SwungRope(int particles, int frames);

// Lets the recording's points move as `system` moves them.
void MoveAs(const SpringMassSystem& system, bool controller_velocity, Recording* recording);

// Adds 0.5 mm of noise to each coordinate of the points, but for those of frame 0.
void AddNoise(Recording* recording, unsigned seed);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SWUNG_ROPE_H_
