// SPDX-License-Identifier: Apache-2.0
// What a smooth body still gains from once it is found. Its fit may be in a side valley, its
// springs are not all those of the object, and its prior is as wide as it was before anything was
// known.
#ifndef PHYSPRING_TRAINER_FITS_SMOOTH_REFINEMENT_H_
#define PHYSPRING_TRAINER_FITS_SMOOTH_REFINEMENT_H_

#include <vector>

#include "trainer/fits/smooth_choice.h"
#include "trainer/journal/work.h"

namespace physpring {

// The chosen body without its superfluous springs (superfluous_springs.h) where it fits about as
// well then. Where it leaves about noise, too, each of these is tried after the other, and kept if
// the body fits better, or as well with less:
// - three times as many sub-steps a frame: with those that are stable, a body can be off by more
//   than the noise tells;
// - a start from springs that are all alike: single classes can be lost in side valleys;
// - fewer springs once more, and the most probable widths of the prior (prior_widths.h).
SmoothlyChosen Refine(const SmoothlyChosen& chosen, const std::vector<Episode>& episodes,
                      const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SMOOTH_REFINEMENT_H_
