// SPDX-License-Identifier: Apache-2.0
// The fit of every spring's own stiffness, dashpot and rest length (factors.h, SpringFactors):
//   Gauss-Newton  under an observer whose gain falls to 0 (observer.h), while it gets on
//   Adam          goes on where contacts or chaotic motions make the residuals too rough for that
#ifndef PHYSPRING_TRAINER_FITS_SPRING_FIT_H_
#define PHYSPRING_TRAINER_FITS_SPRING_FIT_H_

#include "trainer/bodies/chosen_body.h"
#include "trainer/data/fit_data.h"
#include "trainer/journal/work.h"

namespace physpring {

// How many steps Gauss-Newton makes with the last gain, at most; 0 if it is not asked for.
int GaussNewtonSteps(const TrainOptions& options);

// The numbers of `parameters`, among them the springs' own values, fitted from `x` on.
Eigen::VectorXd FitSprings(const Parameters& parameters, const Body& body, const FitData& data,
                           const TrainOptions& options, const Eigen::VectorXd& x, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SPRING_FIT_H_
