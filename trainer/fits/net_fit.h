// SPDX-License-Identifier: Apache-2.0
// The fit of a chosen spring net (bodies/body.h). It ends as one of three:
//   a smooth body        few numbers for the whole body (smooth_fit.h)
//   single stiffnesses   of a smooth body whose springs have factors of their own (spring_fit.h)
//   single springs       each with values of its own (spring_fit.h)
// Single values bend to the motion that they are fitted to. So they have to show that they predict
// a later one better.
#ifndef PHYSPRING_TRAINER_FITS_NET_FIT_H_
#define PHYSPRING_TRAINER_FITS_NET_FIT_H_

#include "trainer/bodies/chosen_body.h"
#include "trainer/data/fit_data.h"
#include "trainer/journal/work.h"

namespace physpring {

struct FittedNet {
  SpringMassSystem system;
  Body body;         // the chosen one, but for the cone and the controllers' velocity
  int substeps = 0;  // a frame, that it was fitted with; 0: as many as are stable
};

// The system of the chosen body that fits the recordings. With --method smooth it is the smooth
// body. Where the options ask for steps or an optimizer of single springs, it has these. Else:
//   1. A smooth body is chosen and fitted (smooth_choice.h). One that surely leaves no more than
//      noise stays.
//   2. Else, and not if LeavesOutSingleValues, all kinds are fitted to a part of the data, and
//      judged on the rest by free motions (held_back.h). The best one is fitted to all, and taken
//      if it then fits no worse than the smooth body.
FittedNet FitNet(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
                 const Work& work);

// Whether step 2 is left out because of many particles in many frames: it would take hours.
bool LeavesOutSingleValues(const FitData& data, const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_NET_FIT_H_
