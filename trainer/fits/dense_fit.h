// SPDX-License-Identifier: Apache-2.0
// The fit of level 0, by gradients and sensitivities of full rollouts:
//   the choice of the body and the start values of its common factors (body_choice.h)
//   those factors again, by Levenberg-Marquardt on all fit frames, under an observer whose gain
//   falls to 0 (observer.h); left out where the choice has fitted single springs
//   single springs (spring_fit.h); a chain that bends (bodies/bending_chain.h) has its common
//   factors fitted further instead, by free motions (chain_fit.h)
// With --method smooth, a smooth body (smooth_fit.h) comes in place of all that follows the choice.
// The start is over-damped and soft: its stiffness is the one of a few (measured in sub-steps a
// frame) that predicts the fit frames best.
#ifndef PHYSPRING_TRAINER_FITS_DENSE_FIT_H_
#define PHYSPRING_TRAINER_FITS_DENSE_FIT_H_

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "twin/twin.h"

namespace physpring {

// Throws Error where the recordings give no body, and if the motion diverges with the start values
// of every candidate.
Twin FitDense(const FitData& data, const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_DENSE_FIT_H_
