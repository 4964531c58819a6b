// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/clusters.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

#include "twin/uniform.h"

namespace physpring {

int ClusterBudget(const SpringGraph& graph, int nodes) {
  return std::clamp(nodes, graph.parts, graph.node_count());
}

std::vector<int> Shuffled(int nodes, std::mt19937_64* random) {
  std::vector<int> order(nodes);
  std::iota(order.begin(), order.end(), 0);
  for (int i = nodes - 1; i > 0; --i) {
    std::swap(order[i], order[static_cast<int>(Uniform(random) * (i + 1))]);
  }
  return order;
}

std::vector<int> FirstOfEachPartThenOthers(const SpringGraph& graph, const std::vector<int>& order,
                                           int count) {
  std::vector<int> chosen, others;
  std::set<int> parts;
  for (int node : order) {
    (parts.insert(graph.part[node]).second ? chosen : others).push_back(node);
  }
  const int missing = count - static_cast<int>(chosen.size());
  chosen.insert(chosen.end(), others.begin(), others.begin() + missing);
  return chosen;
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

namespace {

// Ward's clusters, of which the two that are most alike are joined again and again.
class Agglomeration {
 public:
  Agglomeration(const SpringGraph& graph, const Eigen::MatrixXd& features);

  // Joins two clusters.
  void Join();
  const Assignment& assignment() const { return assignment_; }

 private:
  struct Cluster {
    Eigen::VectorXd mean;
    double variance = 0;  // mean squared distance from the mean
    int size = 1;
    int version = 0;  // grows with each change, so that older entries of the queue are void
    std::set<int> neighbours;
  };
  using Entry = std::tuple<double, int, int, int, int>;  // dissimilarity, clusters, their versions

  void Push(int i, int j);
  void Absorb(int i, int j);  // cluster j into i

  std::vector<Cluster> clusters_;
  Assignment assignment_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

Agglomeration::Agglomeration(const SpringGraph& graph, const Eigen::MatrixXd& features)
    : clusters_(graph.node_count()), assignment_(graph.node_count()) {
  const int count = graph.node_count();
  for (int i = 0; i < count; ++i) {
    assignment_[i] = i;
    clusters_[i].mean = features.row(i);
    for (const SpringGraph::Link& link : graph.links[i]) clusters_[i].neighbours.insert(link.node);
  }
  for (int i = 0; i < count; ++i) {
    for (int j : clusters_[i].neighbours) {
      if (i < j) Push(i, j);
    }
  }
}

void Agglomeration::Push(int i, int j) {
  const Cluster &a = clusters_[std::min(i, j)], &b = clusters_[std::max(i, j)];
  const double dissimilarity = (a.mean - b.mean).squaredNorm() + a.variance + b.variance;
  open_.emplace(dissimilarity, std::min(i, j), std::max(i, j), a.version, b.version);
}

void Agglomeration::Join() {
  for (;;) {
    const auto [dissimilarity, i, j, version_i, version_j] = open_.top();
    open_.pop();
    if (clusters_[i].version != version_i || clusters_[j].version != version_j) continue;
    Absorb(i, j);
    return;
  }
}

void Agglomeration::Absorb(int i, int j) {
  Cluster &a = clusters_[i], &b = clusters_[j];
  const double share = static_cast<double>(b.size) / (a.size + b.size);
  const Eigen::VectorXd apart = b.mean - a.mean;
  a.variance =
      (1 - share) * a.variance + share * b.variance + share * (1 - share) * apart.squaredNorm();
  a.mean += share * apart;
  a.size += b.size;
  ++a.version;
  b.version = -1;
  for (int k : b.neighbours) {
    clusters_[k].neighbours.erase(j);
    if (k == i) continue;
    clusters_[k].neighbours.insert(i);
    a.neighbours.insert(k);
  }
  for (int& cluster : assignment_) {
    if (cluster == j) cluster = i;
  }
  for (int k : a.neighbours) Push(i, k);
}

}  // namespace

Assignment Agglomerate(const SpringGraph& graph, const Eigen::MatrixXd& features, int nodes) {
  Agglomeration clusters(graph, features);
  for (int left = graph.node_count(); left > ClusterBudget(graph, nodes); --left) clusters.Join();
  return Renumber(clusters.assignment());
}

}  // namespace physpring
