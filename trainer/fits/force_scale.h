// SPDX-License-Identifier: Apache-2.0
// Positions tell the ratios of masses, stiffnesses and dashpots, and not how large they are: with
// all of them doubled a body moves alike. Forces at the controllers tell. The factor s for all of
// them is the one that fits the measured forces F best,
//   s = sum f . F / sum f . f,
// f: the force with which a twin's controller pulls at its springs, in all frames that are fitted.
// Where only the sizes of forces are measured, f and F are sizes.
#ifndef PHYSPRING_TRAINER_FITS_FORCE_SCALE_H_
#define PHYSPRING_TRAINER_FITS_FORCE_SCALE_H_

#include "trainer/data/fit_data.h"
#include "twin/twin.h"

namespace physpring {

// Multiplies all masses, stiffnesses and dashpots of all levels, and the values of effects whose
// units are of a force, and sets the twin's force_scale. Does nothing if no force was measured in
// a frame that is fitted, or if the forces are not the twin's at any scale: they correlate with
// them by less than a half, or s is beyond 1e-4 to 1e4.
void ScaleToForces(const FitData& data, Twin* twin);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FORCE_SCALE_H_
