// SPDX-License-Identifier: Apache-2.0
// How far the numbers of a smooth body may be from those of a uniform one is not known before it is
// fitted. A wide prior lets them bend to the noise of one motion, a narrow one hides what the
// object is. The recordings tell: by their evidence (MacKay, Bayesian Interpolation, Neural
// Computation 4, 1992).
#ifndef PHYSPRING_TRAINER_FITS_PRIOR_WIDTHS_H_
#define PHYSPRING_TRAINER_FITS_PRIOR_WIDTHS_H_

#include "trainer/fits/smooth_fit.h"

namespace physpring {

// The widths for which what was measured is most probable, where the residuals are linear in the
// numbers and normal noise of the variance that the fit leaves (Laplace's method).
SmoothBody::Widths MostProbableWidths(const SmoothlyFitted& fit, const LinearisedFit& linearised);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_PRIOR_WIDTHS_H_
