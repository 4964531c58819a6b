// SPDX-License-Identifier: Apache-2.0
// The fit of a chosen body's common factors to the fit frames, by Levenberg-Marquardt, under an
// observer whose gain falls (observer.h).
#ifndef PHYSPRING_TRAINER_FITS_FACTOR_FIT_H_
#define PHYSPRING_TRAINER_FITS_FACTOR_FIT_H_

#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/journal/work.h"

namespace physpring {

// The gains from the index `first_gain` of kObserverGains to the last, with at most `most_steps`
// steps each.
struct GainSchedule {
  int first_gain, most_steps;
};

// The body with its factors fitted, from those that it has.
ChosenBody FitCommonFactors(const ChosenBody& start, const std::vector<Episode>& episodes,
                            const TrainOptions& options, const GainSchedule& schedule,
                            const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FACTOR_FIT_H_
