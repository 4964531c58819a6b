// SPDX-License-Identifier: Apache-2.0
// How large, how fine and how noisy what a recording shows is. All in m.
#ifndef PHYSPRING_TWIN_CHECKS_MOTION_SCALE_H_
#define PHYSPRING_TWIN_CHECKS_MOTION_SCALE_H_

#include <vector>

#include "twin/recording.h"

namespace physpring {

struct MotionScale {
  double size = 0;     // diagonal of the box around the points in frame 0
  double spacing = 0;  // median distance of a particle to its nearest one in frame 0; 0 for one
  double noise = 0;    // standard deviation along an axis (MeasurementNoise)
  double motion = 0;   // root mean square distance of a point from its mean place
};
MotionScale ScaleOf(const Recording& recording);

// Standard deviation along an axis of the noise of the points: the median |third difference| over
// frames, divided by what it is for noise of deviation 1. A motion that is rough from frame to
// frame makes it too large. 0 where no point is seen in four frames in a row.
double MeasurementNoise(const std::vector<Points>& frames);

// The median, and another quantile (0 to 1). 0 where there are none.
double Median(std::vector<double> values);
double Quantile(double part, std::vector<double> values);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_MOTION_SCALE_H_
