// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/body_coordinate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace physpring {
namespace {

constexpr double kNoSpring = std::numeric_limits<double>::infinity();
constexpr double kPatch = 0.5;  // a patch's radius, in distances between neighbours

// Half the mean length of the shortest springs of the nodes.
double PatchRadius(const SpringMassSystem& system) {
  const int nodes = system.node_count();
  Eigen::VectorXd shortest = Eigen::VectorXd::Constant(nodes, kNoSpring);
  for (const auto& [a, b] : system.springs) {
    const double length = (system.position.col(a) - system.position.col(b)).norm();
    for (int node : {a, b}) {
      if (node < nodes) shortest[node] = std::min(shortest[node], length);
    }
  }
  double sum = 0;
  int count = 0;
  for (double length : shortest) {
    if (length == kNoSpring) continue;
    sum += length, ++count;
  }
  return kPatch * sum / std::max(1, count);
}

Points Centred(const SpringMassSystem& system) {
  const Eigen::Vector3d mean = system.position.rowwise().mean();
  return system.position.colwise() - mean;
}

Eigen::Vector3d LongestAxis(const Points& centred) {
  const Eigen::Matrix3d spread = centred * centred.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  Eigen::Vector3d axis = axes.eigenvectors().col(2);
  // its sign: the same on every machine
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? -axis : axis;
}

}  // namespace

Eigen::VectorXd BodyCoordinate(const SpringMassSystem& system) {
  Eigen::VectorXd along = system.rod.arc;
  if (along.size() == 0) {
    const Points centred = Centred(system);
    along = centred.transpose() * LongestAxis(centred);
  }
  const double low = along.minCoeff(), length = along.maxCoeff() - low;
  if (length <= 0) return Eigen::VectorXd::Zero(along.size());
  return (along.array() - low) / length;
}

Points PlaceAcross(const SpringMassSystem& system) {
  Points across = Points::Zero(3, system.position.cols());
  if (!system.rod.empty()) return across;
  const Points centred = Centred(system);
  const Eigen::Vector3d axis = LongestAxis(centred);
  across = centred - axis * (axis.transpose() * centred);
  return across;
}

Eigen::MatrixXd KnotWeights(const Eigen::VectorXd& coordinate, int knots) {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(coordinate.size(), knots);
  for (Eigen::Index i = 0; i < coordinate.size(); ++i) {
    const double place = std::clamp(coordinate[i], 0.0, 1.0) * (knots - 1);
    const int left = std::min(static_cast<int>(place), knots - 2);
    weights(i, left) = 1 - (place - left);
    weights(i, left + 1) = place - left;
  }
  return weights;
}

Eigen::VectorXd PatchWeights(const SpringMassSystem& system, const Eigen::Vector3d& place) {
  const double r = PatchRadius(system);
  const auto nodes = system.position.leftCols(system.node_count());
  Eigen::VectorXd exponent =
      -(nodes.colwise() - place).colwise().squaredNorm().transpose() / (2 * r * r);
  exponent.array() -= exponent.maxCoeff();  // so that a place far away does not underflow
  // a weight of less would be lost in any sum, and numbers near the least one take the processor a
  // hundred times as long
  constexpr double kLeastExponent = -200;
  const Eigen::VectorXd weights =
      (exponent.array() < kLeastExponent).select(0, exponent.array().exp());
  return weights / weights.sum();
}

void PatchWeightsAdjoint(const SpringMassSystem& system, const Eigen::Vector3d& place,
                         const Eigen::VectorXd& weights, const Eigen::VectorXd& weights_bar,
                         Eigen::Ref<Eigen::Vector3d> place_bar) {
  const double r = PatchRadius(system);
  // forward: w = exp(q) / sum exp(q):  q_bar_i = w_i (w_bar_i - w . w_bar)
  const double mean = weights.dot(weights_bar);
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const double q_bar = weights[i] * (weights_bar[i] - mean);
    // forward: q = -|x - p|^2 / 2 r^2
    place_bar += q_bar / (r * r) * (system.position.col(i) - place);
  }
}

std::vector<int> SpreadNodes(const SpringMassSystem& system, int count) {
  const int nodes = system.node_count();
  std::vector<int> spread;
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(nodes, 1e300);
  // the first: farthest from the middle
  const Eigen::Vector3d mean = system.position.leftCols(nodes).rowwise().mean();
  Eigen::Index next = 0;
  (system.position.leftCols(nodes).colwise() - mean).colwise().squaredNorm().maxCoeff(&next);
  while (static_cast<int>(spread.size()) < std::min(count, nodes)) {
    spread.push_back(static_cast<int>(next));
    const Eigen::Vector3d place = system.position.col(next);
    distance = distance.cwiseMin(
        (system.position.leftCols(nodes).colwise() - place).colwise().squaredNorm().transpose());
    distance.maxCoeff(&next);
  }
  return spread;
}

}  // namespace physpring
