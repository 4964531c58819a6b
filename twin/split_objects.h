// SPDX-License-Identifier: Apache-2.0
// A recording of each of the objects that a recording shows.
#ifndef PHYSPRING_TWIN_SPLIT_OBJECTS_H_
#define PHYSPRING_TWIN_SPLIT_OBJECTS_H_

#include <vector>

#include "twin/recording.h"

namespace physpring {

// One for each number of `recording.object`, or the recording itself where there is none. Masses
// are in proportion to the numbers of particles. A point of `surface` goes to the object of the
// nearest point that is seen in its frame, one of `track` to that of the nearest particle in frame
// 0.
std::vector<Recording> SplitObjects(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPLIT_OBJECTS_H_
