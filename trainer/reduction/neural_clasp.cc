// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/neural_clasp.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "trainer/reduction/galerkin.h"
#include "twin/hierarchy.h"
#include "twin/lift.h"

namespace physpring {
namespace {

// A cluster `from` may go to the cluster `to`.
struct Proposal {
  double score;
  int from, to;
};

// Mean scores of all springs between clusters, both ways, the best first.
std::vector<Proposal> Propose(const std::vector<std::array<int, 2>>& pairs,
                              const Eigen::MatrixX2d& scores, const Assignment& cluster) {
  std::map<std::array<int, 2>, std::array<double, 2>> sum_count;
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    const int a = cluster[pairs[e][0]], b = cluster[pairs[e][1]];
    if (a == b) continue;
    for (int way = 0; way < 2; ++way) {
      auto& [sum, count] = sum_count[way == 0 ? std::array{a, b} : std::array{b, a}];
      sum += scores(static_cast<Eigen::Index>(e), way);
      ++count;
    }
  }
  std::vector<Proposal> proposals;
  for (const auto& [ways, sum] : sum_count) {
    proposals.push_back({sum[0] / sum[1], ways[0], ways[1]});
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& p, const Proposal& q) { return p.score > q.score; });
  return proposals;
}

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
  std::iota(cluster.begin(), cluster.end(), 0);
  int left = graph.node_count();
  const int budget = ClusterBudget(graph, nodes);
  while (left > budget) {
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
      --left;
    }
    for (int& c : cluster) c = target[c];
  }
  cluster = Renumber(cluster);
  return choice;
}

ProjectionLoss::ProjectionLoss(const Twin& twin, std::vector<ParticleMotion> motions,
                               const Eigen::Vector3d& up)
    : twin_(twin),
      owner_(NodesOfParticles(twin, static_cast<int>(twin.levels.size()) - 1)),
      motions_(std::move(motions)),
      up_(up) {}

Twin ProjectionLoss::WithLevel(const Assignment& assignment) const {
  Twin twin = twin_;
  twin.levels.push_back(
      {Project(twin_.levels.back().system, assignment, up_).system, assignment, 0});
  return twin;
}

double ProjectionLoss::Error(const Assignment& assignment) const {
  const Twin twin = WithLevel(assignment);
  const int level = static_cast<int>(twin_.levels.size());
  double sum = 0, count = 0;
  for (const ParticleMotion& motion : motions_) {
    const Lift lift(twin, level, motion.start);
    for (const Points& frame : motion.frames) {
      sum += (lift.Apply(AverageOverMembers(twin, level, frame)) - frame).squaredNorm();
      count += static_cast<double>(frame.cols());
    }
  }
  return std::sqrt(sum / count);
}

Eigen::VectorXd ProjectionLoss::DistanceGradient(const Choice& choice,
                                                 const Eigen::MatrixX2d& scores,
                                                 double temperature) const {
  const Assignment& cluster = choice.assignment;
  const Twin twin = WithLevel(cluster);
  const int level = static_cast<int>(twin_.levels.size());
  const std::vector<std::array<int, 2>> pairs = FreePairs(twin_.levels.back().system);
  struct Candidate {
    int pair, way, cluster;
    double carried = 0;  // d loss / d P
  };
  std::vector<std::vector<Candidate>> candidates(twin_.levels.back().system.node_count());
  for (int e = 0; e < static_cast<int>(pairs.size()); ++e) {
    candidates[pairs[e][0]].push_back({e, 0, cluster[pairs[e][1]]});
    candidates[pairs[e][1]].push_back({e, 1, cluster[pairs[e][0]]});
  }
  for (int i = 0; i < static_cast<int>(candidates.size()); ++i) {
    candidates[i].push_back({-1, 0, cluster[i]});  // to stay
  }
  double sum = 0;
  for (const ParticleMotion& motion : motions_) {
    const Lift lift(twin, level, motion.start);
    const Points start = AverageOverMembers(twin, level, motion.start);
    for (const Points& frame : motion.frames) {
      const Points nodes = AverageOverMembers(twin, level, frame);
      const std::vector<Eigen::Matrix3d> rotations = lift.Rotations(nodes);
      const Points off = lift.Apply(nodes) - frame;
      sum += off.squaredNorm();
      for (int p = 0; p < frame.cols(); ++p) {
        for (Candidate& c : candidates[owner_[p]]) {
          // forward: x_p = sum_J P_iJ (X_J + R_J (x_p(0) - X_J(0))), loss = sum |x_p - frame_p|^2
          const Eigen::Vector3d carried =
              nodes.col(c.cluster) +
              rotations[c.cluster] * (motion.start.col(p) - start.col(c.cluster));
          c.carried += 2 * off.col(p).dot(carried - frame.col(p));
        }
      }
    }
  }
  Eigen::VectorXd distance_bar = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(pairs.size()));
  for (const auto& choices : candidates) {
    // forward: P = softmax(score / lambda), score = -D + noise
    Eigen::VectorXd p(static_cast<Eigen::Index>(choices.size()));
    for (std::size_t k = 0; k < choices.size(); ++k) {
      const Candidate& c = choices[k];
      p[static_cast<Eigen::Index>(k)] = c.pair < 0 ? choice.stay : scores(c.pair, c.way);
    }
    p = ((p.array() - p.maxCoeff()) / temperature).exp();
    p /= p.sum();
    double mean = 0;
    for (std::size_t k = 0; k < choices.size(); ++k) {
      mean += p[static_cast<Eigen::Index>(k)] * choices[k].carried;
    }
    for (std::size_t k = 0; k < choices.size(); ++k) {
      if (choices[k].pair < 0) continue;
      distance_bar[choices[k].pair] -=
          p[static_cast<Eigen::Index>(k)] * (choices[k].carried - mean) / temperature / sum;
    }
  }
  return distance_bar;
}

}  // namespace physpring
