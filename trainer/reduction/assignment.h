// SPDX-License-Identifier: Apache-2.0
// An assignment joins the free nodes of a level to clusters, the nodes of the next coarser level.
// Clusters are connected by springs, so that separate objects stay separate; controllers are in
// none. They are numbered by their first members, so the assignment of a system to as many clusters
// as it has nodes is the identity.
#ifndef PHYSPRING_TRAINER_REDUCTION_ASSIGNMENT_H_
#define PHYSPRING_TRAINER_REDUCTION_ASSIGNMENT_H_

#include <cstdint>
#include <functional>
#include <vector>

#include "trainer/reduction/spring_graph.h"
#include "twin/spring_mass_system.h"

namespace physpring {

using Assignment = std::vector<int>;  // the cluster of each free node

// A way to choose one: of a system to `nodes` clusters (as many as ClusterBudget allows), the same
// for the same seed.
using Reduction =
    std::function<Assignment(const SpringMassSystem& system, int nodes, std::uint64_t seed)>;

// Numbers the clusters by their first members.
Assignment Renumber(const Assignment& assignment);

int CountClusters(const Assignment& assignment);

// `nodes`, but at least one cluster for each connected part of the body, at most one a node.
int ClusterBudget(const SpringGraph& graph, int nodes);

// Gives each root (all different, one at least in each part of the graph) the nodes that are
// nearest to it through springs. Springs that leave `region` (of each node; may be empty) are used
// last: a node stays within its region if that has a root it can reach there.
Assignment GrowFromRoots(const SpringGraph& graph, const std::vector<int>& roots,
                         const std::vector<int>& region = {});

// Joins neighbouring clusters, the most similar first, until `nodes` are left, from single nodes.
// The dissimilarity of two clusters is the mean over their pairs of members of the squared distance
// of their features (one row a node): average linkage.
Assignment Agglomerate(const SpringGraph& graph, const Eigen::MatrixXd& features, int nodes);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_ASSIGNMENT_H_
