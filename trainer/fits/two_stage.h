// SPDX-License-Identifier: Apache-2.0
// The fit of level 0 as PhysTwin does it, as the baseline to compare with. Two stages:
//   search       CMA-ES over 12 variables (phystwin_variables.h), 20 generations; springs searched
//                anew for each candidate; objective: mean loss over the fit frames
//   first order  every spring and the contact coefficients, by Adam with one-frame gradients
//                (first_order_stage.h): 200 passes over the fit frames, 100 for a sheet
// Losses and weights as published (loss.h).
//
// What differs from the published program: true masses (the motion is the same); contact changes
// velocities only, the particles of a spring never collide (contact.h), nodes touch the ground
// where start_system.h says; sub-steps from the stability bound unless given; the controllers'
// velocity in the dashpots as the options say (published: off); radii scaled to recordings with
// wider spacing; drag and dashpot not cut to whole numbers; losses divided by true counts, no
// acceleration term. Several recordings are one objective, and one gradient in each step. Particles
// collide with each other only if the options say so (published: on for cloth).
#ifndef PHYSPRING_TRAINER_FITS_TWO_STAGE_H_
#define PHYSPRING_TRAINER_FITS_TWO_STAGE_H_

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "twin/twin.h"

namespace physpring {

// Throws Error where the recordings give no connected body, or one that no controller can move, or
// if no candidate of the first generation can be simulated.
Twin FitTwoStage(const FitData& data, const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_TWO_STAGE_H_
