// SPDX-License-Identifier: Apache-2.0
// The offset between the clock of the points and that of the controllers, as one more number of a
// smooth body (bodies/smooth_body.h) that is fitted to the recordings, with a prior around 0.
#ifndef PHYSPRING_TRAINER_FITS_CLOCK_FIT_H_
#define PHYSPRING_TRAINER_FITS_CLOCK_FIT_H_

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"

namespace physpring {

// How much later than recorded the controllers moved, s. Throws Error as ChooseBody does.
double FitClockOffset(const FitData& data, const TrainOptions& options, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_CLOCK_FIT_H_
