// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_MAKE_FITTER_H_
#define PHYSPRING_TRAINER_MAKE_FITTER_H_

#include <memory>

#include "trainer/fitter.h"
#include "trainer/train_options.h"

namespace physpring {

// The fit of `data` by options.method. Throws Error where the recordings give no connected body.
std::unique_ptr<Fitter> MakeFitter(FitData data, const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MAKE_FITTER_H_
