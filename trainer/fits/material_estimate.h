// SPDX-License-Identifier: Apache-2.0
// What a fitted spring net is made of, and how well the recordings tell it.
#ifndef PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_
#define PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_

#include <vector>

#include "trainer/bodies/body.h"
#include "trainer/data/episode.h"
#include "trainer/data/train_options.h"
#include "twin/material.h"

namespace physpring {

// The material of a system that was fitted to the episodes. The intervals are those of least
// squares in the numbers of a smooth body (smooth_body.h) about the system, from the derivatives J
// of its free motions and the residuals r of mean square s^2: of
//   H^-1,  H = J^T J / s^2 + P      which takes all residuals as independent, and
//   H^-1 S H^-1                     where S is the long-run covariance of J^T r / s^2 of each
//   frame,
//                                   with Bartlett's weights (Newey and West, Econometrica 55, 1987)
// the larger variance counts. The latter allows for errors of a wrong model that are alike over a
// part of the body for a while. P is a prior of a standard deviation of 2 in each logarithm. The
// intervals are twice as wide as that, as bodies of known material showed to be right.
Material EstimateMaterial(const SpringMassSystem& system, const Body& body,
                          const std::vector<Episode>& episodes, const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_
