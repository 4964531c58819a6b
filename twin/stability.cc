// SPDX-License-Identifier: Apache-2.0
#include "twin/stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "twin/effects/effect_set.h"

namespace physpring {
namespace {

// (L x)_i = sum over the springs at i of w (x_i - x_j); controllers stay at 0.
Eigen::VectorXd ApplyLaplacian(const SpringMassSystem& system, const Eigen::VectorXd& weight,
                               const Eigen::VectorXd& x) {
  const int nodes = system.node_count();
  Eigen::VectorXd result = Eigen::VectorXd::Zero(nodes);
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    const double tension = weight[e] * ((a < nodes ? x[a] : 0.0) - (b < nodes ? x[b] : 0.0));
    if (a < nodes) result[a] += tension;
    if (b < nodes) result[b] -= tension;
  }
  return result;
}

// The largest eigenvalue that was found, and a bound of its error.
struct Estimate {
  double eigenvalue, residual;
};

// Of M^-1/2 L M^-1/2, L the Laplacian with weights w of the springs, by Lanczos' method from the
// vector q: the largest eigenvalue of the projection onto a Krylov space, and its residual.
Estimate Lanczos(const SpringMassSystem& system, const Eigen::VectorXd& weight, Eigen::VectorXd q) {
  const int nodes = system.node_count();
  const int steps = std::min(nodes, 80);
  const Eigen::VectorXd inverse_root = system.mass.cwiseSqrt().cwiseInverse();
  Eigen::VectorXd previous = Eigen::VectorXd::Zero(nodes);
  q.normalize();
  Eigen::VectorXd diagonal(steps), beside(steps);  // of the projection
  int size = 0;
  for (;;) {
    const Eigen::VectorXd x = inverse_root.cwiseProduct(q);
    Eigen::VectorXd next = inverse_root.cwiseProduct(ApplyLaplacian(system, weight, x));
    diagonal[size] = q.dot(next);
    next -= diagonal[size] * q;
    if (size > 0) next -= beside[size - 1] * previous;
    beside[size] = next.norm();
    ++size;
    // no residual: the space holds the eigenvectors
    if (size == steps || beside[size - 1] <= 1e-12 * diagonal.head(size).maxCoeff()) break;
    previous = q;
    q = next / beside[size - 1];
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> projection;
  projection.computeFromTridiagonal(diagonal.head(size), beside.head(size - 1));
  const double residual =
      beside[size - 1] * std::abs(projection.eigenvectors()(size - 1, size - 1));
  return {projection.eigenvalues()[size - 1], residual};
}

// Upper estimate of the largest eigenvalue, from two start vectors, the same each time and without
// symmetry: one spread evenly, and one where the diagonal is large, as the modes of a few nodes are
// that uneven weights have at the top of the spectrum.
double LargestEigenvalue(const SpringMassSystem& system, const Eigen::VectorXd& weight) {
  const int nodes = system.node_count();
  Eigen::VectorXd even(nodes), diagonal = Eigen::VectorXd::Zero(nodes);
  for (int e = 0; e < system.spring_count(); ++e) {
    for (int end : system.springs[e]) {
      if (end < nodes) diagonal[end] += weight[e] / system.mass[end];
    }
  }
  if (diagonal.isZero(0)) return 0;
  for (int i = 0; i < nodes; ++i) even[i] = 1 + std::sin(12.9898 * (i + 1) * (i + 1));
  const Estimate spread = Lanczos(system, weight, even);
  const Estimate local = Lanczos(system, weight, even.cwiseProduct(diagonal.cwiseAbs2()));
  const Estimate& larger = local.eigenvalue > spread.eigenvalue ? local : spread;
  return larger.eigenvalue + larger.residual;
}

}  // namespace

StabilityBound ComputeStabilityBound(const SpringMassSystem& system) {
  if (!system.effects.empty()) return ComputeStabilityBound(BoundingSystem(system));
  const double omega_squared = LargestEigenvalue(system, system.stiffness);
  const double gamma = LargestEigenvalue(system, system.dashpot);
  // h^2 omega^2 + 2 h gamma = 4, in a form that does not cancel
  const double root = gamma + std::sqrt(gamma * gamma + 4 * omega_squared);
  return {std::sqrt(omega_squared), gamma,
          root > 0 ? 4 / root : std::numeric_limits<double>::infinity()};
}

int StableSubsteps(const StabilityBound& bound, double frame_time, double safety) {
  const double substeps = std::ceil(frame_time / (safety * bound.timestep) - 1e-9);
  return static_cast<int>(std::clamp(substeps, 1.0, 1e6));
}

}  // namespace physpring
