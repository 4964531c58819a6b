// SPDX-License-Identifier: Apache-2.0
// What reductions make clusters with: roots that other nodes go to, or neighbours that are joined
// one after the other.
#ifndef PHYSPRING_TRAINER_REDUCTION_CLUSTERS_H_
#define PHYSPRING_TRAINER_REDUCTION_CLUSTERS_H_

#include <random>
#include <vector>

#include "trainer/projection/assignment.h"
#include "trainer/projection/spring_graph.h"
#include "twin/points.h"

namespace physpring {

// `nodes`, but at least one cluster for each connected part of the body, at most one a node.
int ClusterBudget(const SpringGraph& graph, int nodes);

// All nodes in random order (Fisher-Yates).
std::vector<int> Shuffled(int nodes, std::mt19937_64* random);

// The first `count` of `order`, after the first one of each part of the graph.
std::vector<int> FirstOfEachPartThenOthers(const SpringGraph& graph, const std::vector<int>& order,
                                           int count);

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

#endif  // PHYSPRING_TRAINER_REDUCTION_CLUSTERS_H_
