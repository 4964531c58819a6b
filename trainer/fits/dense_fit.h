// SPDX-License-Identifier: Apache-2.0
// The fit of level 0, by gradients and sensitivities of full rollouts:
//   the choice of the body and the start values of its common factors (body_choice.h)
//   a spring net becomes a smooth body, or gets single stiffnesses or springs (net_fit.h)
//   a chain that bends (bodies/bending_chain.h) has its common factors fitted further, by free
//   motions (chain_fit.h)
// Where points and controllers have clocks of their own, their offset is found before all that
// (clock_fit.h). The start is over-damped and soft: its stiffness is the one of a few (measured in
// sub-steps a frame) that predicts the fit frames best.
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
