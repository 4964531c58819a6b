// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/neural_clasp.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace physpring {
namespace {

// A cluster `from` may go to the cluster `to`.
struct Proposal {
  double score;
  int from, to;
  int way;  // 2 pair + way of a spring between them
};

// Mean scores of all springs between clusters, both ways, the best first.
std::vector<Proposal> Propose(const std::vector<std::array<int, 2>>& pairs,
                              const Eigen::MatrixX2d& scores, const Assignment& cluster) {
  struct Sum {
    double scores = 0;
    int count = 0, way = 0;
  };
  std::map<std::array<int, 2>, Sum> sums;
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    const int a = cluster[pairs[e][0]], b = cluster[pairs[e][1]];
    if (a == b) continue;
    for (int way = 0; way < 2; ++way) {
      Sum& sum = sums[way == 0 ? std::array{a, b} : std::array{b, a}];
      sum.scores += scores(static_cast<Eigen::Index>(e), way);
      ++sum.count;
      sum.way = 2 * static_cast<int>(e) + way;
    }
  }
  std::vector<Proposal> proposals;
  for (const auto& [ends, sum] : sums) {
    proposals.push_back({sum.scores / sum.count, ends[0], ends[1], sum.way});
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& p, const Proposal& q) { return p.score > q.score; });
  return proposals;
}

// The ways that each node can go: 2 pair + way.
std::vector<std::vector<int>> WaysOf(const SpringMassSystem& system) {
  const std::vector<std::array<int, 2>> pairs = FreePairs(system);
  std::vector<std::vector<int>> ways(system.node_count());
  for (int e = 0; e < static_cast<int>(pairs.size()); ++e) {
    for (int way = 0; way < 2; ++way) ways[pairs[e][way]].push_back(2 * e + way);
  }
  return ways;
}

// The softmax of -D and of staying: its shift and its sum.
struct Softmax {
  double top, sum, temperature;

  Softmax(const std::vector<int>& ways, const Eigen::VectorXd& distance, double stay,
          double temperature_)
      : top(stay), sum(0), temperature(temperature_) {
    for (int way : ways) top = std::max(top, -distance[way / 2]);
    sum = Weight(stay);
    for (int way : ways) sum += Weight(-distance[way / 2]);
  }
  double Weight(double score) const { return std::exp((score - top) / temperature); }
};

}  // namespace

std::vector<std::array<int, 2>> FreePairs(const SpringMassSystem& system) {
  std::vector<std::array<int, 2>> pairs;
  for (const auto& [a, b] : system.springs) {
    if (std::max(a, b) < system.node_count()) pairs.push_back({a, b});
  }
  return pairs;
}

Eigen::MatrixX2d DrawScores(const Eigen::VectorXd& distance, double temperature,
                            std::mt19937_64* random) {
  Eigen::MatrixX2d scores(distance.size(), 2);
  for (Eigen::Index e = 0; e < distance.size(); ++e) {
    for (int way = 0; way < 2; ++way) {
      scores(e, way) = -distance[e];
      if (temperature == 0) continue;
      const double uniform = (static_cast<double>((*random)() >> 11) + 0.5) * 0x1p-53;
      scores(e, way) -= temperature * std::log(-std::log(uniform));
    }
  }
  return scores;
}

Choice ChooseClusters(const SpringMassSystem& system, const Eigen::MatrixX2d& scores, int nodes) {
  const SpringGraph graph(system);
  const std::vector<std::array<int, 2>> pairs = FreePairs(system);
  Choice choice;
  Assignment& cluster = choice.assignment;
  cluster.resize(graph.node_count());
  choice.chosen.assign(graph.node_count(), Choice::kStays);
  std::iota(cluster.begin(), cluster.end(), 0);
  int left = graph.node_count();
  const int budget = ClusterBudget(graph, nodes);
  for (bool first = true; left > budget; first = false) {
    enum : char { kFree, kStays, kGoes };
    std::vector<char> role(graph.node_count(), kFree);
    std::vector<int> target(graph.node_count());
    std::iota(target.begin(), target.end(), 0);
    for (const Proposal& p : Propose(pairs, scores, cluster)) {
      if (left == budget) break;
      if (role[p.from] != kFree || role[p.to] == kGoes) continue;
      role[p.from] = kGoes;
      role[p.to] = kStays;
      target[p.from] = p.to;
      choice.stay = p.score;
      if (first) choice.chosen[p.from] = p.way;
      --left;
    }
    for (int& c : cluster) c = target[c];
  }
  cluster = Renumber(cluster);
  return choice;
}

double LogProbability(const SpringMassSystem& system, const Eigen::VectorXd& distance,
                      const Choice& choice, double temperature) {
  const std::vector<std::vector<int>> ways = WaysOf(system);
  double log_probability = 0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Softmax softmax(ways[i], distance, choice.stay, temperature);
    const int way = choice.chosen[i];
    const double score = way == Choice::kStays ? choice.stay : -distance[way / 2];
    log_probability += (score - softmax.top) / temperature - std::log(softmax.sum);
  }
  return log_probability;
}

Eigen::VectorXd LogProbabilityGradient(const SpringMassSystem& system,
                                       const Eigen::VectorXd& distance, const Choice& choice,
                                       double temperature) {
  const std::vector<std::vector<int>> ways = WaysOf(system);
  Eigen::VectorXd distance_bar = Eigen::VectorXd::Zero(distance.size());
  for (std::size_t i = 0; i < ways.size(); ++i) {
    // forward: log P = s_chosen / lambda - log sum exp(s / lambda), s = -D
    const Softmax softmax(ways[i], distance, choice.stay, temperature);
    for (int way : ways[i]) {
      const double p = softmax.Weight(-distance[way / 2]) / softmax.sum;
      distance_bar[way / 2] -= ((way == choice.chosen[i] ? 1 : 0) - p) / temperature;
    }
  }
  return distance_bar;
}

}  // namespace physpring
