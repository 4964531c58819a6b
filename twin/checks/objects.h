// SPDX-License-Identifier: Apache-2.0
// Whether a recording shows one object. Points near each other in frame 0 belong together if
// the distance between them stays about the same. What hangs together over such pairs is one
// object.
#ifndef PHYSPRING_TWIN_CHECKS_OBJECTS_H_
#define PHYSPRING_TWIN_CHECKS_OBJECTS_H_

#include "twin/recording.h"

namespace physpring {

// The number of the object of each particle and controller (N+M+C), from 0 on by the first point;
// empty if there is one. Interior particles and controllers belong to the object of the nearest
// point. A group of less than a twentieth of the points, or of fewer than 3, is no object: its
// points count to the nearest one.
Eigen::VectorXi FindObjects(const Recording& recording);

// The same where each particle's object is declared: `declared` (N+M), any whole numbers. A
// controller belongs to the object of the nearest particle in frame 0.
Eigen::VectorXi DeclaredObjects(const Recording& recording, const Eigen::VectorXi& declared);

// 1 where recording.object is empty.
int ObjectCount(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_OBJECTS_H_
