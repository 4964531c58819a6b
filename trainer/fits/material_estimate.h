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
// squares (Seber and Wild, Nonlinear Regression, 1989, section 2.1) in the numbers of a smooth body
// (smooth_body.h) about the system:
//   covariance = (J^T J / (s^2 tau) + P)^-1
// where J are the free motions' derivatives, s^2 is the mean square of the residuals, tau their
// correlation time in frames (residual_correlation.h), and P the precision of the smooth body's
// prior. They say nothing of errors that a wrong model makes.
Material EstimateMaterial(const SpringMassSystem& system, const Body& body,
                          const std::vector<Episode>& episodes, const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_
