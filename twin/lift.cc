// SPDX-License-Identifier: Apache-2.0
#include "twin/lift.h"

#include <algorithm>
#include <utility>

#include "twin/hierarchy.h"
#include "twin/rotation.h"

namespace physpring {
namespace {

// The free nodes that springs join to each free node, ascending.
std::vector<std::vector<int>> SpringNeighbours(const SpringMassSystem& system) {
  std::vector<std::vector<int>> neighbours(system.node_count());
  for (const auto& [a, b] : system.springs) {
    if (a >= system.node_count() || b >= system.node_count()) continue;
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  for (auto& list : neighbours) std::sort(list.begin(), list.end());
  return neighbours;
}

}  // namespace

Lift::Lift(const Twin& twin, int level, const Points& particles_start)
    : identity_(level == 0),
      particles_start_(particles_start),
      nodes_start_(AverageOverMembers(twin, level, particles_start)),
      neighbours_(SpringNeighbours(LevelOf(twin, level).system)) {
  if (identity_) return;
  const std::vector<int> owner = NodesOfParticles(twin, level);
  const Points& particles = twin.levels[0].system.position;
  const Points& nodes = twin.levels[level].system.position;
  constexpr double kNear = 1e-6;  // m: keeps the weight of a node that is a particle finite
  for (int i = 0; i < static_cast<int>(owner.size()); ++i) {
    std::vector<std::pair<double, int>> near{{0, owner[i]}};
    for (int node : neighbours_[owner[i]]) near.emplace_back(0, node);
    for (auto& [squared, node] : near) squared = (nodes.col(node) - particles.col(i)).squaredNorm();
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), Anchors{}.size()));

    Anchors& anchors = anchors_.emplace_back();
    double sum = 0;
    for (std::size_t k = 0; k < near.size(); ++k) {
      anchors[k] = {near[k].second, 1 / (near[k].first + kNear * kNear)};
      sum += anchors[k].weight;
    }
    for (Anchor& anchor : anchors) anchor.weight /= sum;
  }
}

Lift::Neighbourhood Lift::NeighbourhoodOf(int node, const Points& nodes) const {
  Neighbourhood about{nodes_start_(Eigen::all, neighbours_[node]),
                      nodes(Eigen::all, neighbours_[node])};
  about.from.colwise() -= nodes_start_.col(node);
  about.to.colwise() -= nodes.col(node);
  return about;
}

std::vector<Eigen::Matrix3d> Lift::Rotations(const Points& nodes) const {
  std::vector<Eigen::Matrix3d> rotations(neighbours_.size(), Eigen::Matrix3d::Identity());
  for (int i = 0; i < static_cast<int>(neighbours_.size()); ++i) {
    if (neighbours_[i].empty()) continue;
    const Neighbourhood about = NeighbourhoodOf(i, nodes);
    rotations[i] = FitRotation(about.from, about.to);
  }
  return rotations;
}

Points Lift::Apply(const Points& nodes) const {
  if (identity_) return nodes;
  const std::vector<Eigen::Matrix3d> rotations = Rotations(nodes);
  Points particles = Points::Zero(3, particles_start_.cols());
  for (int i = 0; i < particles.cols(); ++i) {
    for (const Anchor& anchor : anchors_[i]) {
      if (anchor.weight == 0) continue;
      const int node = anchor.node;
      particles.col(i) +=
          anchor.weight *
          (nodes.col(node) + rotations[node] * (particles_start_.col(i) - nodes_start_.col(node)));
    }
  }
  return particles;
}

Points Lift::Adjoint(const Points& nodes, const Points& particles_bar) const {
  if (identity_) return particles_bar;
  Points nodes_bar = Points::Zero(3, nodes.cols());
  std::vector<Eigen::Matrix3d> rotations_bar(neighbours_.size(), Eigen::Matrix3d::Zero());
  for (int i = 0; i < particles_bar.cols(); ++i) {
    for (const Anchor& anchor : anchors_[i]) {
      if (anchor.weight == 0) continue;
      // forward: x_i += w [X + R (x_i(0) - X(0))]
      const Eigen::Vector3d bar = anchor.weight * particles_bar.col(i);
      const int node = anchor.node;
      nodes_bar.col(node) += bar;
      rotations_bar[node] += bar * (particles_start_.col(i) - nodes_start_.col(node)).transpose();
    }
  }
  for (int i = 0; i < static_cast<int>(neighbours_.size()); ++i) {
    if (neighbours_[i].empty() || rotations_bar[i].isZero(0)) continue;
    // forward: R = FitRotation(from, to), to = X_j - X_i
    const Neighbourhood about = NeighbourhoodOf(i, nodes);
    Points to_bar = Points::Zero(3, about.to.cols());
    AddFitRotationAdjoint(about.from, about.to, rotations_bar[i], &to_bar);
    for (std::size_t j = 0; j < neighbours_[i].size(); ++j) {
      nodes_bar.col(neighbours_[i][j]) += to_bar.col(static_cast<Eigen::Index>(j));
    }
    nodes_bar.col(i) -= to_bar.rowwise().sum();
  }
  return nodes_bar;
}

}  // namespace physpring
