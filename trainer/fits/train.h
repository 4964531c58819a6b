// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_FITS_TRAIN_H_
#define PHYSPRING_TRAINER_FITS_TRAIN_H_

#include <optional>

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "twin/twin.h"

namespace physpring {

// The twin of `data`: level 0 by options.method, or that of the twin `dense` as it is, and the
// coarser levels that options.levels asks for. Forces that were measured set the scale of masses
// and stiffnesses at the end. Throws Error where the recordings give no connected body, where the
// motion diverges whatever is tried, and where levels are no coarser.
Twin Train(const FitData& data, const TrainOptions& options, const std::optional<Twin>& dense,
           const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_TRAIN_H_
