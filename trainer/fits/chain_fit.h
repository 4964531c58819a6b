// SPDX-License-Identifier: Apache-2.0
// The fit of a chain that bends (bodies/bending_chain.h), after the choice. It has no more than
// common factors: they get what single springs would get, more recordings and more steps. Then they
// go on by free motions: a search (free_motion_search.h), and a descent of the rod's shape
// (free_motion_descent.h).
#ifndef PHYSPRING_TRAINER_FITS_CHAIN_FIT_H_
#define PHYSPRING_TRAINER_FITS_CHAIN_FIT_H_

#include "trainer/bodies/chosen_body.h"
#include "trainer/data/fit_data.h"
#include "trainer/journal/work.h"

namespace physpring {

ChosenBody FitChain(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
                    const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_CHAIN_FIT_H_
