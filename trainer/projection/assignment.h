// SPDX-License-Identifier: Apache-2.0
// An assignment joins the free nodes of a level to clusters, the nodes of the next coarser level.
// Clusters are connected by springs, so that separate objects stay separate; controllers are in
// none. They are numbered by their first members, so the assignment of a system to as many clusters
// as it has nodes is the identity.
#ifndef PHYSPRING_TRAINER_PROJECTION_ASSIGNMENT_H_
#define PHYSPRING_TRAINER_PROJECTION_ASSIGNMENT_H_

#include <vector>

namespace physpring {

using Assignment = std::vector<int>;  // the cluster of each free node

// Numbers the clusters by their first members.
Assignment Renumber(const Assignment& assignment);

int CountClusters(const Assignment& assignment);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_PROJECTION_ASSIGNMENT_H_
