// SPDX-License-Identifier: Apache-2.0
// What a smooth body still gains from once it is found: fewer springs, and shorter sub-steps.
#ifndef PHYSPRING_TRAINER_FITS_SMOOTH_REFINEMENT_H_
#define PHYSPRING_TRAINER_FITS_SMOOTH_REFINEMENT_H_

#include <vector>

#include "trainer/fits/smooth_choice.h"
#include "trainer/journal/work.h"

namespace physpring {

// The chosen body without its superfluous springs (superfluous_springs.h) where it fits about as
// well then; and with three times as many sub-steps a frame where what they leave is about noise
// and they leave less: with those that are stable, a body can be off by more than the noise tells.
SmoothlyChosen Refine(const SmoothlyChosen& chosen, const std::vector<Episode>& episodes,
                      const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SMOOTH_REFINEMENT_H_
