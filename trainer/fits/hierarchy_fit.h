// SPDX-License-Identifier: Apache-2.0
// The fit of a twin's coarser levels, one after the other: for each an assignment of the nodes of
// the level below (trainer/reduction), its Galerkin projection, and the fit of its parameters
// (level_fit.h). A level that is done does not change any more.
#ifndef PHYSPRING_TRAINER_FITS_HIERARCHY_FIT_H_
#define PHYSPRING_TRAINER_FITS_HIERARCHY_FIT_H_

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "twin/twin.h"

namespace physpring {

// Throws Error if a level of options.ratios would have no fewer nodes than the one below it, or
// fewer than 2.
void ExpectCoarserLevels(const FitData& data, const TrainOptions& options);

// `dense` with the levels that options.levels asks for.
Twin FitHierarchy(const Twin& dense, const FitData& data, const TrainOptions& options,
                  const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_HIERARCHY_FIT_H_
