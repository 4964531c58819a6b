// SPDX-License-Identifier: Apache-2.0
// Splats that have moved, as splats of their own: for files that other programs show.
#ifndef PHYSPRING_SPLATS_SETTLE_H_
#define PHYSPRING_SPLATS_SETTLE_H_

#include "splats/splats.h"

namespace physpring {

// Splats that look as these do: scales and rotations of their covariances, harmonics that are
// turned.
Splats Settle(const PlacedSplats& placed);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_SETTLE_H_
