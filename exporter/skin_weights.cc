// SPDX-License-Identifier: Apache-2.0
#include "exporter/skin_weights.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr int kNeighbours = 8;
constexpr double kRegularisation = 1e-3;  // a part of the total of phi
constexpr double kLeastWeight = 2e-3;     // smaller ones are left out

// The weights of the nodes in `near` (the last one only says how far they reach).
Eigen::VectorXd Weights(const std::vector<Neighbour>& near, const Points& nodes,
                        const Eigen::Vector3d& vertex) {
  const double reach = 1.01 * std::max(near.back().distance, 1e-12);
  const Eigen::Index count = static_cast<Eigen::Index>(near.size());
  Eigen::Matrix4Xd p(4, count);
  Eigen::VectorXd phi(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    phi[i] = std::pow(1 - near[i].distance / reach, 2);
    p.col(i) << 1, (nodes.col(near[i].index) - vertex) / reach;
  }
  Eigen::Matrix4d moment = p * phi.asDiagonal() * p.transpose();
  moment.diagonal().tail<3>().array() += kRegularisation * phi.sum();
  const Eigen::Vector4d solution = moment.ldlt().solve(Eigen::Vector4d::Unit(0));
  Eigen::VectorXd weights = phi.cwiseProduct(p.transpose() * solution);
  weights = (weights.array().abs() < kLeastWeight).select(0, weights);
  return weights / weights.sum();
}

}  // namespace

std::vector<std::vector<SkinWeight>> BindToNodes(const Points& vertices, const Points& nodes) {
  const NeighbourSearch search(nodes);
  std::vector<std::vector<SkinWeight>> carried(static_cast<std::size_t>(nodes.cols()));
  for (int v = 0; v < vertices.cols(); ++v) {
    const std::vector<Neighbour> near = search.Nearest(vertices.col(v), kNeighbours + 1);
    const Eigen::VectorXd weights = Weights(near, nodes, vertices.col(v));
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      if (weights[i] != 0) carried[near[i].index].push_back({v, weights[i]});
    }
  }
  return carried;
}

}  // namespace physpring
