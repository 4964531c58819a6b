// SPDX-License-Identifier: Apache-2.0
// Accelerations over a time s, long enough for noise to matter little:
//   a(t) = (x(t + s) - 2 x(t) + x(t - s)) / s^2
#ifndef PHYSPRING_TWIN_CHECKS_SMOOTH_MOTION_H_
#define PHYSPRING_TWIN_CHECKS_SMOOTH_MOTION_H_

#include <vector>

#include "twin/recording.h"

namespace physpring {

// |a| of all points that are seen in the three frames, m/s^2. s = 0.03 s.
std::vector<double> AccelerationSizes(const Recording& recording);

// Root mean square distance of the controllers from their mean places, m; 0 without any.
double MotionOfControllers(const Recording& recording);

// The object and what holds it, as two points and a force, in a frame.
struct Pull {
  Eigen::Vector3d arm;    // from the mean of the controllers to that of the points, m
  Eigen::Vector3d force;  // a - g of the mean of the points, m/s^2: what the controllers give
};
// Of the frames in which three quarters of the points are seen, and in the two around. s = 0.1 s.
std::vector<Pull> Pulls(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_SMOOTH_MOTION_H_
