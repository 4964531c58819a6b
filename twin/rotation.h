// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_ROTATION_H_
#define PHYSPRING_TWIN_ROTATION_H_

#include "twin/points.h"

namespace physpring {

// The rotation that takes the columns of `from` nearest to those of `to` (both 3 x points, about
// the centre of the rotation; at least one column), i.e. that of the polar decomposition of to
// from^T:
//   R = argmin sum_j |to_j - R from_j|^2
// What the columns leave open (the twist about a straight line) is turned as little as possible.
Eigen::Matrix3d FitRotation(const Points& from, const Points& to);

// `points` (3 x any number), moved as the rigid body whose columns go from `from` to `to` does, as
// nearly as one can: about the means, turned by FitRotation.
Points MoveRigidly(const Points& from, const Points& to, const Points& points);

// Adds to `to_bar` the derivative of a loss with respect to `to`, rotation_bar being the one with
// respect to FitRotation(from, to).
void AddFitRotationAdjoint(const Points& from, const Points& to,
                           const Eigen::Matrix3d& rotation_bar, Points* to_bar);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_ROTATION_H_
