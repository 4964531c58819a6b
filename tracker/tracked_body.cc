// SPDX-License-Identifier: Apache-2.0
#include "tracker/tracked_body.h"

#include <algorithm>

#include "twin/stability.h"

namespace physpring {

TrackedBody BodyToTrack(const SpringMassSystem& system, double fps, int substeps) {
  constexpr double kSafety = 0.9;  // docs/decisions/157
  const int most_stages = system.dashpot_stages;
  TrackedBody body{system, substeps};
  StabilityBound bound = ComputeStabilityBound(system);
  if (substeps == 0) {
    const FrameCut cut = CheapestCut(bound, 1 / fps, kSafety, most_stages);
    body.system.dashpot_stages = cut.dashpot_stages;
    body.substeps = cut.substeps;
    return body;
  }
  const double timestep = 1 / (kSafety * fps * substeps);
  if (timestep > bound.timestep) {
    SoftenStiffNodes(timestep, &body.system);
    const auto softer = body.system.stiffness.array() < system.stiffness.array();
    body.softened = static_cast<double>(softer.count()) / std::max(1, system.spring_count());
    bound = ComputeStabilityBound(body.system);
    body.substeps = std::max(substeps, StableSubsteps(bound, 1 / fps, kSafety));
  }
  body.system.dashpot_stages =
      FewestStages(bound, 1 / (kSafety * fps * body.substeps), most_stages);
  return body;
}

}  // namespace physpring
