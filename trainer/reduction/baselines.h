// SPDX-License-Identifier: Apache-2.0
// Assignments that nothing is learned for.
#ifndef PHYSPRING_TRAINER_REDUCTION_BASELINES_H_
#define PHYSPRING_TRAINER_REDUCTION_BASELINES_H_

#include "trainer/reduction/assignment.h"

namespace physpring {

// A random subset of the nodes; each other node goes to the nearest of them through springs.
Assignment RandomAssignment(const SpringMassSystem& system, int nodes, std::uint64_t seed);

// k-means (Lloyd, started by k-means++) of the reference positions. The node nearest to each centre
// is the root of a cluster; nodes that no spring within theirs joins to it go to a neighbouring
// one.
Assignment KMeansAssignment(const SpringMassSystem& system, int nodes, std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_BASELINES_H_
