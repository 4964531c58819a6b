// SPDX-License-Identifier: Apache-2.0
// The fit of a smooth body (bodies/smooth_body.h): Levenberg-Marquardt on its few numbers, until it
// has arrived, from the soft start of the chosen body, under an observer whose gain falls to 0
// (observer.h).
#ifndef PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_
#define PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_

#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/journal/work.h"

namespace physpring {

// The system of the chosen body whose numbers fit the episodes best. The contact with the ground
// starts as chosen, all else as soft as the choice began.
SpringMassSystem FitSmoothBody(const ChosenBody& chosen, const std::vector<Episode>& episodes,
                               const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_
