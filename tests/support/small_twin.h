// SPDX-License-Identifier: Apache-2.0
// A small twin with coarser levels, and recordings of its motion: what programs that judge, show or
// export twins are tested on.
#ifndef PHYSPRING_TESTS_SUPPORT_SMALL_TWIN_H_
#define PHYSPRING_TESTS_SUPPORT_SMALL_TWIN_H_

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// A block of 5 x 4 x 2 particles, 20 mm apart (about 100 g, unequal masses), held by 2 controllers
// above: 32 points and 8 interior particles. Level 1 joins the two layers, level 2 pairs of those.
// `levels`: 1 to 3.
Twin SmallTwin(int levels);

// What a camera would see of level 0 of `twin` while the controllers swing sideways: `frames`
// frames at 50 fps, without noise, all points seen. Its hash is empty.
Recording RecordingOfMotion(const Twin& twin, int frames);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SMALL_TWIN_H_
