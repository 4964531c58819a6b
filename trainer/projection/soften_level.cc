// SPDX-License-Identifier: Apache-2.0
#include "trainer/projection/soften_level.h"

#include <algorithm>
#include <cmath>

#include "twin/stability.h"

namespace physpring {

int MostSubstepsOfLevels(const TwinLevel& dense, double fps) {
  const int stages = dense.system.dashpot_stages;
  const double stable = ComputeStabilityBound(dense.system).CheapestTimestep(stages);
  return std::max(StableSubsteps(stable, 1 / fps, kStepSafety),
                  static_cast<int>(std::ceil(dense.substeps_per_second / fps * CostOf(stages))));
}

void SoftenLevel(int most_substeps, double fps, SpringMassSystem* level) {
  const int stages = level->dashpot_stages;
  const double timestep = 1 / (fps * most_substeps * kStepSafety);
  if (ComputeStabilityBound(*level).CheapestTimestep(stages) >= timestep) return;
  SoftenStiffNodes(timestep * CostOf(stages), level);
}

}  // namespace physpring
