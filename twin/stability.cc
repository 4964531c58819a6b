// SPDX-License-Identifier: Apache-2.0
#include "twin/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace physpring {
namespace {

// Largest eigenvalue of M^-1/2 L M^-1/2, L the Laplacian with weights w of the springs; controllers
// do not move.
double LargestEigenvalue(const SpringMassSystem& system, const Eigen::VectorXd& weight) {
  const int nodes = system.node_count();
  const Eigen::VectorXd inverse_root = system.mass.cwiseSqrt().cwiseInverse();
  // a start vector without symmetry, the same each time
  Eigen::VectorXd q(nodes);
  for (int i = 0; i < nodes; ++i) q[i] = 1 + std::sin(12.9898 * (i + 1) * (i + 1));
  q.normalize();
  double eigenvalue = 0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Eigen::VectorXd x = inverse_root.cwiseProduct(q);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(nodes);
    for (int e = 0; e < system.spring_count(); ++e) {
      const auto [a, b] = system.springs[e];
      const double tension = weight[e] * ((a < nodes ? x[a] : 0.0) - (b < nodes ? x[b] : 0.0));
      if (a < nodes) force[a] += tension;
      if (b < nodes) force[b] -= tension;
    }
    q = inverse_root.cwiseProduct(force);
    const double next = q.norm();
    if (next == 0) return 0;
    q /= next;
    const bool settled = std::abs(next - eigenvalue) < 1e-4 * next;
    eigenvalue = next;
    if (settled && iteration > 10) break;
  }
  return eigenvalue;
}

}  // namespace

StabilityBound ComputeStabilityBound(const SpringMassSystem& system) {
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
