// SPDX-License-Identifier: Apache-2.0
#include "splats/settle.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "splats/harmonics.h"

namespace physpring {
namespace {

// Harmonics are functions on the sphere: those of a degree stay among themselves when it turns.
// With values Y(d) at directions d, the turned weights are Y^+ Y(turn^T d) of the weights before.
void TurnHarmonics(const PlacedSplats& placed, Splats* splats) {
  const int degree = splats->degree, count = HarmonicCount(degree);
  constexpr int kDirections = 32;  // more than there are harmonics
  Eigen::Matrix3Xf directions(3, kDirections);
  Eigen::MatrixXf values(kDirections, count);
  Eigen::Matrix<float, 1, HarmonicCount(kMostHarmonicDegree)> row;
  for (int k = 0; k < kDirections; ++k) {  // evenly on the sphere, along a spiral
    const float z = 1 - (2 * static_cast<float>(k) + 1) / kDirections;
    const float angle = 2.3999632F * static_cast<float>(k), r = std::sqrt(1 - z * z);
    directions.col(k) << r * std::cos(angle), r * std::sin(angle), z;
    Harmonics(degree, Eigen::Vector3f(directions.col(k)), row.data());
    values.row(k) = row.head(count);
  }
  const Eigen::MatrixXf inverse = (values.transpose() * values).inverse() * values.transpose();
  Eigen::MatrixXf turned(kDirections, count);
  for (int i = 0; i < splats->count(); ++i) {
    const Eigen::Map<const Eigen::Matrix3f> turn(placed.turn.col(i).data());
    for (int k = 0; k < kDirections; ++k) {
      Harmonics(degree, Eigen::Vector3f(turn.transpose() * directions.col(k)), row.data());
      turned.row(k) = row.head(count);
    }
    Eigen::Map<Eigen::MatrixXf> weights(splats->harmonics.col(i).data(), count, 3);
    weights = (inverse * (turned * weights)).eval();
  }
}

}  // namespace

Splats Settle(const PlacedSplats& placed) {
  Splats splats = *placed.look;
  splats.position = placed.position;
  for (int i = 0; i < splats.count(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> own(placed.Covariance(i));
    Eigen::Matrix3f axes = own.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    const Eigen::Quaternionf q(axes);
    splats.rotation.col(i) << q.w(), q.x(), q.y(), q.z();
    constexpr float kLeast = 1e-16F;  // m^2
    splats.log_scale.col(i) = 0.5F * own.eigenvalues().array().max(kLeast).log();
  }
  if (placed.turn.cols() > 0 && splats.degree > 0) TurnHarmonics(placed, &splats);
  return splats;
}

}  // namespace physpring
