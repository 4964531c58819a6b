// SPDX-License-Identifier: Apache-2.0
#include "trainer/projection/soften_level.h"

#include <algorithm>
#include <cmath>

#include "twin/stability.h"

namespace physpring {

int MostSubstepsOfLevels(const TwinLevel& dense, double fps) {
  return std::max(StableSubsteps(ComputeStabilityBound(dense.system), 1 / fps, kStepSafety),
                  static_cast<int>(std::ceil(dense.substeps_per_second / fps)));
}

void SoftenLevel(int most_substeps, double fps, SpringMassSystem* level) {
  const double timestep = 1 / (fps * most_substeps * kStepSafety);
  if (ComputeStabilityBound(*level).timestep < timestep) SoftenStiffNodes(timestep, level);
}

}  // namespace physpring
