// SPDX-License-Identifier: Apache-2.0
// k-means (Lloyd, started by k-means++) of the reference positions. The node nearest to each centre
// is the root of a cluster; nodes that no spring within theirs joins to it go to a neighbouring
// one.
#ifndef PHYSPRING_TRAINER_REDUCTION_KMEANS_H_
#define PHYSPRING_TRAINER_REDUCTION_KMEANS_H_

#include <cstdint>

#include "trainer/projection/assignment.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// At most `nodes` clusters, as ClusterBudget allows; the same for the same seed.
Assignment KMeansAssignment(const SpringMassSystem& system, int nodes, std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_KMEANS_H_
