// SPDX-License-Identifier: Apache-2.0
// The one place that judges whether a recording can be what it is taken for: positions in metres
// and gravity where it is said to be, of one object that moves with what holds it. And whether a
// twin explains a recording at all. Each line names the value that gave it away.
#ifndef PHYSPRING_TWIN_CHECKS_PLAUSIBILITY_H_
#define PHYSPRING_TWIN_CHECKS_PLAUSIBILITY_H_

#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// Objects that people hold are smaller and larger than this, m.
inline constexpr double kLargestObject = 10, kSmallestObject = 1e-3;

// What is odd about a recording whose `start` is set, a line each; none for a plausible one.
std::vector<std::string> FindOddities(const Recording& recording);

// Says that a twin explains little of a motion, given its track error and that of a body that does
// not move, m; `noise` is that of the points (MeasurementNoise), m. Empty if it explains enough, or
// if nothing moves beyond the noise.
std::string TooLittleExplained(double track, double motionless, double noise);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_PLAUSIBILITY_H_
