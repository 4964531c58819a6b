// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_MAKE_FITTER_H_
#define PHYSPRING_TRAINER_MAKE_FITTER_H_

#include <memory>
#include <optional>

#include "trainer/fitter.h"
#include "trainer/train_options.h"

namespace physpring {

// The fit of `data`: level 0 by options.method, or that of the twin `dense` as it is, and the
// coarser levels that options.levels asks for. Throws Error where the recordings give no connected
// body.
std::unique_ptr<Fitter> MakeFitter(FitData data, const TrainOptions& options,
                                   const std::optional<Twin>& dense = {});

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MAKE_FITTER_H_
