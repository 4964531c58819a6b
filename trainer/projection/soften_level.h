// SPDX-License-Identifier: Apache-2.0
// A coarse level takes no more sub-steps a frame than level 0: it would be the slower one. But a
// projection sums the springs between clusters, and a light cluster may get many.
#ifndef PHYSPRING_TRAINER_PROJECTION_SOFTEN_LEVEL_H_
#define PHYSPRING_TRAINER_PROJECTION_SOFTEN_LEVEL_H_

#include "twin/twin.h"

namespace physpring {

// The most sub-steps of a frame, in those of one dashpot stage: what level 0, `dense`, needs.
int MostSubstepsOfLevels(const TwinLevel& dense, double fps);

// Softens the springs at nodes that need more sub-steps a frame than cost as much as so many of one
// dashpot stage.
void SoftenLevel(int most_substeps, double fps, SpringMassSystem* level);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_PROJECTION_SOFTEN_LEVEL_H_
