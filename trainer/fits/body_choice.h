// SPDX-License-Identifier: Apache-2.0
// The choice of a body (bodies/body.h) and of the start values of its common factors, on held-back
// frames. In rounds, under an observer whose gain falls (observer.h):
//   far      each candidate's factors are fitted with the two highest gains, from the best of a few
//            start stiffnesses and frictions; the best three go on
//   near     those are fitted with lower gains; among nets this decides
//   springs  the best two, where a chain that bends (bodies/bending_chain.h) is one of them: nets
//   are
//            fitted a few steps further, spring by spring, with the same low gain, and judged by a
//            free motion as well; a chain by its factors
// All contenders treat the controllers' velocity alike. What that is worth shows in a better fit
// (net_fit.h).
#ifndef PHYSPRING_TRAINER_FITS_BODY_CHOICE_H_
#define PHYSPRING_TRAINER_FITS_BODY_CHOICE_H_

#include "trainer/bodies/chosen_body.h"
#include "trainer/data/fit_data.h"
#include "trainer/journal/work.h"

namespace physpring {

// Computes in single precision: for a choice that is enough. Throws Error where the recordings give
// no body, and if the motion diverges with the start values of every candidate.
ChosenBody ChooseBody(const FitData& data, const TrainOptions& asked, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_BODY_CHOICE_H_
