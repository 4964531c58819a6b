// SPDX-License-Identifier: Apache-2.0
// How exactly the points were measured, from the measurements alone. The fourth difference in time
// of a smooth motion is small; that of white noise of standard deviation s has the deviation
// sqrt(70) s. The median over points and coordinates keeps what moves fast from counting.
#ifndef PHYSPRING_DIAGNOSIS_NOISE_FLOOR_H_
#define PHYSPRING_DIAGNOSIS_NOISE_FLOOR_H_

#include <vector>

#include "twin/recording.h"

namespace physpring {

// Standard deviation of a coordinate of a measured point, m; NaN if no point was seen in five
// frames in a row.
double MeasurementNoise(const std::vector<const Recording*>& recordings);

// The track error that a perfect model would still show: mean length of noise of that deviation in
// three dimensions, s sqrt(8 / pi).
double TrackNoiseFloor(double noise);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_NOISE_FLOOR_H_
