// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/assignment.h"

#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <tuple>

namespace physpring {

Assignment Renumber(const Assignment& assignment) {
  std::map<int, int> number;
  Assignment renumbered;
  for (int cluster : assignment) {
    renumbered.push_back(
        number.try_emplace(cluster, static_cast<int>(number.size())).first->second);
  }
  return renumbered;
}

int CountClusters(const Assignment& assignment) {
  return 1 + *std::max_element(assignment.begin(), assignment.end());
}

int ClusterBudget(const SpringGraph& graph, int nodes) {
  return std::clamp(nodes, graph.parts, graph.node_count());
}

Assignment GrowFromRoots(const SpringGraph& graph, const std::vector<int>& roots,
                         const std::vector<int>& region) {
  // Dijkstra from all roots at once; springs that leave a region count before all lengths
  using Entry = std::tuple<int, double, int, int>;  // regions left, length, root, node
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (int root : roots) open.emplace(0, 0.0, root, root);
  Assignment assignment(graph.node_count(), -1);
  while (!open.empty()) {
    const auto [left, length, root, node] = open.top();
    open.pop();
    if (assignment[node] >= 0) continue;
    assignment[node] = root;
    for (const SpringGraph::Link& link : graph.links[node]) {
      if (assignment[link.node] >= 0) continue;
      const int leaves = region.empty() || region[link.node] == region[node] ? 0 : 1;
      open.emplace(left + leaves, length + link.length, root, link.node);
    }
  }
  return Renumber(assignment);
}

Assignment Agglomerate(const SpringGraph& graph, const Eigen::MatrixXd& features, int nodes) {
  struct Cluster {
    Eigen::VectorXd mean;
    double variance = 0;  // mean squared distance from the mean
    int size = 1;
    int version = 0;  // grows with each change, so that older entries of the queue are void
    std::set<int> neighbours;
  };
  const int count = graph.node_count();
  std::vector<Cluster> clusters(count);
  Assignment assignment(count);
  using Entry = std::tuple<double, int, int, int, int>;  // dissimilarity, clusters, their versions
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto push = [&](int i, int j) {
    const Cluster &a = clusters[std::min(i, j)], &b = clusters[std::max(i, j)];
    const double dissimilarity = (a.mean - b.mean).squaredNorm() + a.variance + b.variance;
    open.emplace(dissimilarity, std::min(i, j), std::max(i, j), a.version, b.version);
  };
  for (int i = 0; i < count; ++i) {
    assignment[i] = i;
    clusters[i].mean = features.row(i);
    for (const SpringGraph::Link& link : graph.links[i]) clusters[i].neighbours.insert(link.node);
  }
  for (int i = 0; i < count; ++i) {
    for (int j : clusters[i].neighbours) {
      if (i < j) push(i, j);
    }
  }
  for (int left = count; left > ClusterBudget(graph, nodes);) {
    const auto [dissimilarity, i, j, version_i, version_j] = open.top();
    open.pop();
    Cluster &a = clusters[i], &b = clusters[j];
    if (a.version != version_i || b.version != version_j) continue;
    const double share = static_cast<double>(b.size) / (a.size + b.size);
    const Eigen::VectorXd apart = b.mean - a.mean;
    a.variance =
        (1 - share) * a.variance + share * b.variance + share * (1 - share) * apart.squaredNorm();
    a.mean += share * apart;
    a.size += b.size;
    ++a.version;
    b.version = -1;
    for (int k : b.neighbours) {
      clusters[k].neighbours.erase(j);
      if (k == i) continue;
      clusters[k].neighbours.insert(i);
      a.neighbours.insert(k);
    }
    for (int& cluster : assignment) {
      if (cluster == j) cluster = i;
    }
    for (int k : a.neighbours) push(i, k);
    --left;
  }
  return Renumber(assignment);
}

}  // namespace physpring
