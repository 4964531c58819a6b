// SPDX-License-Identifier: Apache-2.0
// The fit of a chosen spring net (bodies/body.h). It ends as one of two:
//   a smooth body   few numbers for the whole body (smooth_fit.h)
//   single springs  each with values of its own (spring_fit.h)
// Single springs bend to the motion that they are fitted to. So they have to show that they predict
// a later one better.
#ifndef PHYSPRING_TRAINER_FITS_NET_FIT_H_
#define PHYSPRING_TRAINER_FITS_NET_FIT_H_

#include "trainer/data/fit_data.h"
#include "trainer/fits/body_choice.h"
#include "trainer/journal/work.h"

namespace physpring {

// The system of the chosen body that fits the recordings. With --method smooth it is the smooth
// body. Where the options ask for steps or an optimizer of single springs, it has these. Else:
//   1. The smooth body is fitted. It stays if it leaves no more than noise
//   (residual_correlation.h).
//   2. If not, and if the single springs of the choice explain the fit frames better as they are,
//   it
//      gets single springs.
//   3. Else both kinds are fitted to a part of the data, and judged on the rest by free motions
//      (held_back.h). The better one is fitted to all.
SpringMassSystem FitNet(const BodyChoice& choice, const FitData& data, const TrainOptions& options,
                        const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_NET_FIT_H_
