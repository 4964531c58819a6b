// SPDX-License-Identifier: Apache-2.0
// Grasps that begin and end. The array `held` says in which frames a controller holds the object.
// Each time that it holds is a grasp, and a controller of its own: it takes hold of the particles
// that are near it when it begins. So where it was then is carried back to frame 0 with the points
// around it, and springs are found there.
#ifndef PHYSPRING_TWIN_GRASPS_H_
#define PHYSPRING_TWIN_GRASPS_H_

#include <string>
#include <vector>

#include "twin/npz_fields.h"
#include "twin/recording.h"

namespace physpring {

// A controller that holds from its first frame to its last one.
struct Grasp {
  int controller, first, last;
};

// By `held`, where each controller holds in two frames in a row: first the first ones of the
// controllers, in their order, then the others.
std::vector<Grasp> AllGrasps(const Recording& recording);

// Reads `controllers` and, if it is there, `held`, (frames, C). A controller may be NaN where it
// does not hold: it is where it last held, or will hold first. Throws Error where one holds and is
// NaN, and for one that holds in no two frames in a row.
void ReadControllers(NpzFields& fields, const std::string& frames, Recording* recording);

// Makes a controller of each grasp: first the first ones of the controllers, in their order, then
// the others. `start`, `rest`, `rod` and `force` get their columns. Throws Error where no point
// is seen when a grasp begins.
void SplitGrasps(const NpzFields& fields, Recording* recording);

// Whether some controller lets go, or takes hold after the start.
bool HasChangingGrasps(const Recording& recording);

// Sets shape_when_held from `held`. What is not seen in such a frame went along with the points
// that are, from frame 0.
void FindShapesWhenHeld(Recording* recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_GRASPS_H_
