// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_COLUMN_NAMES_H_
#define PHYSPRING_TWIN_COLUMN_NAMES_H_

#include <string>

#include "twin/recording.h"

namespace physpring {

// A column of `start` and `rest` in words: "point 3", "interior particle 0", "controller 1".
std::string NameOfColumn(const Recording& recording, Eigen::Index column);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_COLUMN_NAMES_H_
