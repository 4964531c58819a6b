// SPDX-License-Identifier: Apache-2.0
// What the scripted policies share: a hand that points down, and places on the object.
#ifndef PHYSPRING_ROLLOUT_POLICIES_HAND_DOWN_H_
#define PHYSPRING_ROLLOUT_POLICIES_HAND_DOWN_H_

#include "rollout/policies/waypoints.h"

namespace physpring {

// A parallel gripper that is turned by half a turn is the same: `yaw` [rad] or half turns from it,
// the one nearest to `about`.
double HalfTurnNear(double yaw, double about);

// The hand upright at `position` [m], the broad sides of its pads along `yaw` [rad].
Waypoint HandDown(const Eigen::Vector3d& position, double yaw, double gripper, int frames);

// Mean of the particles for which `chosen` holds. Throws PolicyError if there are none, or if it is
// not finite.
Eigen::Vector3d MeanWhere(const Points& particles,
                          const Eigen::Array<bool, Eigen::Dynamic, 1>& chosen);

// The angle [rad] by which `points` are turned about the vertical since `reference`, index by
// index, in the least squares sense.
double YawBetween(const Points& reference, const Points& points);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_HAND_DOWN_H_
