// SPDX-License-Identifier: Apache-2.0
// How far the true body may be from the fitted one: Laplace's approximation of the posterior.
#ifndef PHYSPRING_TRAINER_FITS_POSTERIOR_ESTIMATE_H_
#define PHYSPRING_TRAINER_FITS_POSTERIOR_ESTIMATE_H_

#include <vector>

#include "trainer/bodies/body.h"
#include "trainer/data/episode.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "twin/posterior.h"

namespace physpring {

struct EstimatedPosterior {
  Posterior samples;    // what twins are drawn from: they explain the recordings about as well
  Posterior intervals;  // wider: what the true values are sought in
};

// The posterior of a spring net that was fitted to the episodes, in the numbers of a smooth body
// (smooth_body.h) about it. From the derivatives J of free motions and the N residuals r of mean
// square s^2, the covariance for samples is
//   H^-1,  H = J^T J / (f s^2) + P   which takes all residuals as independent.
// That for intervals is the smallest one that is nowhere below this nor below
//   H^-1 S H^-1                      where S is the long-run covariance of J^T r / (f^1/2 s^2) of
//                                    each frame, with Bartlett's weights (Newey and West,
//                                    Econometrica 55, 1987).
// P is a prior of a standard deviation of 2 in each number. No direction of intervals changes a
// logarithm by more than that, and none of samples by more than log 2: several such directions
// together leave the range in which anything is linear.
//
// The factor f = 1 + rho N / n is for errors of the model: rho is the share of s^2 that is no noise
// (residual_correlation.h), so that rho N is the misfit that no noise explains, in units of chi^2.
// It counts as if each of the n numbers could hide as much of it as is its share.
//
// J is that of secants over about a standard deviation, on the side where the motion changes more:
// motions that depend on a number by leaps have derivatives that promise too much, and those of
// weak springs, too little.
EstimatedPosterior EstimatePosterior(const SpringMassSystem& system, const Body& body,
                                     const std::vector<Episode>& episodes,
                                     const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_POSTERIOR_ESTIMATE_H_
