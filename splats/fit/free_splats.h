// SPDX-License-Identifier: Apache-2.0
// Splats whose numbers are free: what a fit changes, in double precision. Their colour is the same
// from all sides.
#ifndef PHYSPRING_SPLATS_FIT_FREE_SPLATS_H_
#define PHYSPRING_SPLATS_FIT_FREE_SPLATS_H_

#include <Eigen/Core>

#include "splats/splats.h"

namespace physpring {

// The rows of a splat's numbers: x y z [m]; logarithms of the deviations [log m]; w x y z, of any
// length but 0; the logit of the opacity; red, green, blue, 0 to 1.
enum FreeRow {
  kFreePosition = 0,
  kFreeScale = 3,
  kFreeRotation = 6,
  kFreeLogit = 10,
  kFreeColour = 11,
  kFreeRows = 14
};

// One column a splat.
using FreeSplats = Eigen::Matrix<double, kFreeRows, Eigen::Dynamic>;
using FreeSplat = Eigen::Matrix<double, kFreeRows, 1>;

// As they are stored: harmonics of degree 0.
Splats StoredSplats(const FreeSplats& splats);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_FIT_FREE_SPLATS_H_
