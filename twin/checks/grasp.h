// SPDX-License-Identifier: Apache-2.0
// Whether an object moves with what holds it, under the gravity that is declared. Each function
// gives a line in words, or nothing.
#ifndef PHYSPRING_TWIN_CHECKS_GRASP_H_
#define PHYSPRING_TWIN_CHECKS_GRASP_H_

#include <string>

#include "twin/checks/motion_scale.h"
#include "twin/recording.h"

namespace physpring {

// An object that hangs freely hangs down. Where all controllers are at one point, or on one line,
// they hold no torque about it: over time the mean of
//   arm x (a - g)
// along that line vanishes, arm being the way from the controllers' mean to the points' and a the
// points' mean acceleration. Where it does not, gravity has another direction. Nothing is said of
// objects on a ground.
std::string OddGravity(const Recording& recording, const MotionScale& scale);

// A controller that starts far from all particles, as a wrist is from the fingers.
std::string FarGrasp(const Recording& recording, const MotionScale& scale);

// A controller that leaves the points that it held.
std::string ReleasedGrasp(const Recording& recording, const MotionScale& scale);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_GRASP_H_
