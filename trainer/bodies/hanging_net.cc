// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/hanging_net.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "trainer/bodies/spring_net.h"

namespace physpring {
namespace {

constexpr double kFallTime = 0.04;    // s
constexpr double kMostFallen = 0.3;   // of what a slack net falls by
constexpr double kClearOfGround = 2;  // spacings between neighbours, at least
// Directions in which springs are softer than this part of the mean carry nothing: along them noise
// decides.
constexpr double kTooSoft = 1e-3;

class HangingNetKind : public BodyKind {
 public:
  std::string Addition() const override { return " that hang"; }
  bool has_single_springs() const override { return true; }
  void Free(const SpringMassSystem& /*base*/, ParameterOptions* options) const override {
    options->stretch = true;
  }
  int SearchedEffect(const Parameters& factors) const override {
    return SpringNet().SearchedEffect(factors);
  }
  LevenbergMarquardtOptions FactorOptions(const Recording& recording) const override {
    return SpringNet().FactorOptions(recording);
  }
  double handicap() const override { return 1; }
};

bool IsOnGround(const Recording& recording) {
  if (!recording.ground) return false;
  const Points points = recording.start.leftCols(recording.particle_count());
  const double lowest =
      (recording.ground->head<3>().transpose() * points).minCoeff() - (*recording.ground)[3];
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  return lowest < kClearOfGround * size / std::cbrt(static_cast<double>(points.cols()));
}

// The way that the points fell from frame 0 to `frame`, m: in space, or against the controllers,
// whichever is less.
double Fallen(const Recording& recording, int frame) {
  const Eigen::Vector3d down = recording.gravity.normalized();
  double sum = 0, seen = 0;
  for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
    const double way = down.dot(recording.points[frame].col(i) - recording.points[0].col(i));
    if (!std::isfinite(way)) continue;
    sum += way;
    ++seen;
  }
  if (seen == 0) return std::numeric_limits<double>::infinity();
  const Points hands = recording.controllers[frame] - recording.controllers[0];
  const double held = down.dot(hands.rowwise().mean());
  return std::min(std::abs(sum / seen), std::abs(sum / seen - held));
}

}  // namespace

bool HangsAtRest(const Recording& recording) {
  if (recording.controller_count() == 0 || recording.rest_given || !recording.rod.empty() ||
      recording.gravity.norm() == 0 || !recording.velocity.isZero(0) || IsOnGround(recording)) {
    return false;
  }
  const int frame = std::clamp(static_cast<int>(std::lround(kFallTime * recording.fps)), 1,
                               recording.train_frames - 1);
  const double time = frame / recording.fps;
  return Fallen(recording, frame) < kMostFallen * 0.5 * recording.gravity.norm() * time * time;
}

Eigen::VectorXd StrainShares(const SpringMassSystem& system, const Eigen::Vector3d& gravity) {
  const int nodes = system.node_count();
  const int springs = system.spring_count();
  // column e: the force on each node per tension of spring e
  std::vector<Eigen::Triplet<double>> entries;
  for (int e = 0; e < springs; ++e) {
    const auto [a, b] = system.springs[e];
    const Eigen::Vector3d direction =
        (system.position.col(b) - system.position.col(a)).normalized();
    for (int i = 0; i < 3; ++i) {
      if (a < nodes) entries.emplace_back(3 * a + i, e, direction[i]);
      if (b < nodes) entries.emplace_back(3 * b + i, e, -direction[i]);
    }
  }
  Eigen::SparseMatrix<double> forces(3 * nodes, springs);
  forces.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double> stiffness =
      forces * system.stiffness.asDiagonal() * Eigen::SparseMatrix<double>(forces.transpose());
  Eigen::SparseMatrix<double> identity(3 * nodes, 3 * nodes);
  identity.setIdentity();
  stiffness += kTooSoft * stiffness.diagonal().mean() * identity;
  Eigen::VectorXd weight(3 * nodes);
  for (int i = 0; i < nodes; ++i) weight.segment<3>(3 * i) = -system.mass[i] * gravity;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(stiffness);
  const Eigen::VectorXd strain =
      (forces.transpose() * solver.solve(weight)).cwiseQuotient(system.rest_length);
  const double largest = strain.cwiseAbs().maxCoeff();
  return largest > 0 ? Eigen::VectorXd(strain / largest) : Eigen::VectorXd::Zero(springs);
}

Body HangingNet(const Recording& recording, Body body) {
  static const HangingNetKind kind;
  body.kind = &kind;
  body.strain = StrainShares(StartSystem(recording, body, kSoftestStart), recording.gravity);
  body.stretch = kStretches[0];
  return body;
}

double RestRatio(double x) { return x > -0.5 ? 1 / (1 + x) : 2 - 4 * (x + 0.5); }
double RestRatioSlope(double x) { return x > -0.5 ? -1 / ((1 + x) * (1 + x)) : -4; }
double StrainOfRatio(double r) { return r < 2 ? 1 / r - 1 : -0.5 - (r - 2) / 4; }

}  // namespace physpring
