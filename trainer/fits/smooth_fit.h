// SPDX-License-Identifier: Apache-2.0
// The fit of a smooth body (bodies/smooth_body.h): Levenberg-Marquardt on its few numbers, until it
// has arrived, from the soft start of the chosen body, under an observer whose gain falls to 0
// (observer.h).
#ifndef PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_
#define PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_

#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/journal/work.h"

namespace physpring {

// A smooth body and its numbers.
struct SmoothlyFitted {
  SmoothBody body;
  Eigen::VectorXd x;

  SpringMassSystem System() const { return body.Apply(x); }
};

// The numbers that fit the episodes best. The contact with the ground starts as chosen, all else as
// soft as the choice began.
SmoothlyFitted FitSmoothBody(const ChosenBody& chosen, const std::vector<Episode>& episodes,
                             const TrainOptions& options, const SmoothBody::Options& body,
                             const Work& work);

// The same for other episodes of the same object, from those numbers on, by free motions alone.
SmoothlyFitted FitOn(const SmoothlyFitted& start, const ChosenBody& chosen,
                     const std::vector<Episode>& episodes, const TrainOptions& options,
                     const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_
