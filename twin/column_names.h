// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_COLUMN_NAMES_H_
#define PHYSPRING_TWIN_COLUMN_NAMES_H_

#include <string>

#include "twin/recording.h"

namespace physpring {

// A column of `start` and `rest` in words: "point 3", "interior particle 0", "controller 1".
std::string NameOfColumn(const Recording& recording, Eigen::Index column);

// "controller 1"; of one that takes hold later "controller 4, the grasp from frame 54 on,", since
// people know a hand's number and not that of its grasp (grasps.h).
std::string NameOfController(const Recording& recording, int controller);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_COLUMN_NAMES_H_
