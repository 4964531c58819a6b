// SPDX-License-Identifier: Apache-2.0
// Whether a recording's rod (`order`, `rod`) can be that of the object as it is seen in frame 0.
#ifndef PHYSPRING_TWIN_CHECKS_ROD_SHAPE_H_
#define PHYSPRING_TWIN_CHECKS_ROD_SHAPE_H_

#include <string>

#include "twin/checks/motion_scale.h"
#include "twin/recording.h"

namespace physpring {

// Says that the rod is longer or shorter between neighbours than in frame 0, or that those which
// follow each other are far apart. Empty if it is as it should be, or if there is no rod.
std::string OddRod(const Recording& recording, const MotionScale& scale);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_ROD_SHAPE_H_
