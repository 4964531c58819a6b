// SPDX-License-Identifier: Apache-2.0
// The system that a fit starts from: springs found in the recording's stress-free positions, all of
// the same axial stiffness E A (stiffness E A / L), equal dashpots, equal masses.
#ifndef PHYSPRING_TRAINER_BODIES_START_SYSTEM_H_
#define PHYSPRING_TRAINER_BODIES_START_SYSTEM_H_

#include "twin/recording.h"
#include "twin/spring_mass_system.h"
#include "twin/topology.h"

namespace physpring {

// Throws Error where the recording gives no connected body (topology.h).
SpringMassSystem MakeStartSystem(const Recording& recording, const TopologyOptions& topology);

// Scales stiffness and dashpots so that the largest stable sub-step, times `safety`, is 1 /
// substeps of a frame, over-damped: the fastest mode's damping rate is half its frequency.
// Over-damped, because gradients of long rollouts are of use only then; measured in sub-steps,
// because that is what a stiffness costs, and no unit of it is natural for all objects.
void ScaleToSubsteps(double frame_time, double substeps, double safety, SpringMassSystem* system);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_START_SYSTEM_H_
