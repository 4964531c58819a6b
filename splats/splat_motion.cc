// SPDX-License-Identifier: Apache-2.0
#include "splats/splat_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "splats/in_parallel.h"
#include "twin/rotation.h"

namespace physpring {
namespace {

using Matrix = Eigen::Matrix3f;
using Vector = Eigen::Vector3f;

constexpr double kRigid = 0.05;  // e
constexpr double kNear = 1e-6;   // m: keeps the weight of a node that is a splat finite

}  // namespace

SplatMotion::SplatMotion(const Splats& splats, const Points& nodes)
    : splats_(splats), start_(AsStored(splats)), nodes_start_(nodes) {
  const NeighbourSearch search(nodes);
  Bind(search);
  Surround(search);
}

// Each splat to the nodes nearest to it.
void SplatMotion::Bind(const NeighbourSearch& search) {
  for (int i = 0; i < splats_.count(); ++i) {
    const std::vector<Neighbour> near =
        search.Nearest(splats_.position.col(i).cast<double>(), kAnchors);
    std::array<Anchor, kAnchors>& anchors = anchors_.emplace_back();
    double sum = 0;
    for (const Neighbour& node : near) sum += 1 / std::pow(node.distance + kNear, 2);
    for (std::size_t k = 0; k < near.size(); ++k) {
      const double weight = 1 / std::pow(near[k].distance + kNear, 2) / sum;
      anchors[k] = {near[k].index, static_cast<float>(weight)};
    }
  }
}

// Each node by the nodes nearest to it.
void SplatMotion::Surround(const NeighbourSearch& search) {
  const Points& nodes = nodes_start_;
  for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
    Neighbourhood& about = neighbourhoods_.emplace_back();
    std::vector<double> roots;
    for (const Neighbour& other : search.Nearest(nodes.col(node), kNeighbours + 1)) {
      if (other.index == node) continue;
      about.nodes.push_back(other.index);
      roots.push_back(1 / (other.distance + kNear));
    }
    about.weights =
        Eigen::Map<const Eigen::VectorXd>(roots.data(), static_cast<Eigen::Index>(roots.size()));
    about.from = nodes(Eigen::all, about.nodes).colwise() - nodes.col(node);
    about.from *= about.weights.asDiagonal();
    const Eigen::Matrix3d spread = about.from * about.from.transpose();
    about.rigid = kRigid * std::max(spread.trace() / 3, kNear);
    about.inverse = (spread + about.rigid * Eigen::Matrix3d::Identity()).inverse();
  }
}

Eigen::Matrix3d SplatMotion::Deformation(int node, const Points& nodes,
                                         Eigen::Matrix3d* rotation) const {
  const Neighbourhood& about = neighbourhoods_[node];
  rotation->setIdentity();
  if (about.nodes.empty()) return *rotation;
  Points to = nodes(Eigen::all, about.nodes).colwise() - nodes.col(node);
  to *= about.weights.asDiagonal();
  *rotation = FitRotation(about.from, to);
  return (to * about.from.transpose() + about.rigid * *rotation) * about.inverse;
}

PlacedSplats SplatMotion::At(const Points& nodes, int threads) const {
  const int node_count = static_cast<int>(nodes.cols()), count = splats_.count();
  std::vector<Matrix> deformations(node_count), rotations(node_count);
  InParallel(node_count, threads, [&](int n) {
    Eigen::Matrix3d rotation;
    deformations[n] = Deformation(n, nodes, &rotation).cast<float>();
    rotations[n] = rotation.cast<float>();
  });
  PlacedSplats placed = start_;
  placed.turn.resize(9, count);
  InParallel(count, threads, [&](int i) {
    Vector x = Vector::Zero();
    Matrix f = Matrix::Zero();
    for (const Anchor& anchor : anchors_[i]) {
      if (anchor.weight == 0) continue;
      const Matrix& own = deformations[anchor.node];
      const Vector arm = splats_.position.col(i) - nodes_start_.col(anchor.node).cast<float>();
      x += anchor.weight * (nodes.col(anchor.node).cast<float>() + own * arm);
      f += anchor.weight * own;
    }
    placed.position.col(i) = x;
    placed.SetCovariance(i, f * start_.Covariance(i) * f.transpose());
    placed.turn.col(i) = rotations[anchors_[i][0].node].reshaped();
  });
  return placed;
}

}  // namespace physpring
