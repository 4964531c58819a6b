// SPDX-License-Identifier: Apache-2.0
// The system that a fit starts from. Its springs are found in the recording's stress-free
// positions. They have the same axial stiffness E A (stiffness E A / L) and equal dashpots; nodes
// have equal masses.
#ifndef PHYSPRING_TRAINER_BODIES_START_SYSTEM_H_
#define PHYSPRING_TRAINER_BODIES_START_SYSTEM_H_

#include "twin/recording.h"
#include "twin/spring_mass_system.h"
#include "twin/topology.h"

namespace physpring {

// The start system of a recording. Throws Error where the recording gives no connected body
// (topology.h).
SpringMassSystem MakeStartSystem(const Recording& recording, const TopologyOptions& topology);

// Scales stiffness and dashpots so that the largest stable sub-step, times `safety`, is 1 /
// substeps of a frame. The system is over-damped then: the fastest mode's damping rate is half its
// frequency. It is so because gradients of long rollouts are of use only then. The stiffness is
// measured in sub-steps because that is what it costs, and no unit of it is natural for all
// objects.
void ScaleToSubsteps(double frame_time, double substeps, double safety, SpringMassSystem* system);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_START_SYSTEM_H_
