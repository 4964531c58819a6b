// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/gauss_newton.h"

#include <algorithm>
#include <cmath>

namespace physpring {

GaussNewtonState GaussNewtonStep(LeastSquares* problem, const GaussNewtonState& state,
                                 const GaussNewtonOptions& options) {
  GaussNewtonState next = state;
  const auto r = problem->Linearise(state.x);
  if (!r) {
    next.converged = true;
    return next;
  }
  const double variance = r->squaredNorm() / static_cast<double>(r->size());
  next.mean_square = variance;
  const auto prior = [&](const Eigen::VectorXd& x) { return x.cwiseAbs2().dot(options.precision); };
  const double objective = static_cast<double>(r->size()) + prior(state.x);
  const Eigen::VectorXd gradient =
      problem->JacobianTransposedTimes(*r) / variance + options.precision.cwiseProduct(state.x);

  // curvature along the gradient sets the size of the damping
  const Eigen::VectorXd direction = gradient.cwiseQuotient(options.scale);
  const double curvature = problem->JacobianTimes(direction).squaredNorm() / variance /
                           direction.dot(options.scale.cwiseProduct(direction));
  const Eigen::VectorXd diagonal = options.precision + state.damping * curvature * options.scale;

  // conjugate gradients, preconditioned by `scale` and the prior
  const Eigen::VectorXd inverse =
      (options.precision + 0.1 * curvature * options.scale + diagonal).cwiseInverse();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(gradient.size());
  Eigen::VectorXd residual = -gradient;
  Eigen::VectorXd z = inverse.cwiseProduct(residual), p = z;
  double rz = residual.dot(z);
  const double target = 1e-4 * rz;
  for (int i = 0; i < options.conjugate_gradient_steps && rz > target; ++i) {
    const Eigen::VectorXd ap =
        problem->JacobianTransposedTimes(problem->JacobianTimes(p)) / variance +
        diagonal.cwiseProduct(p);
    const double pap = p.dot(ap);
    if (!(pap > 0)) break;
    const double alpha = rz / pap;
    step += alpha * p;
    residual -= alpha * ap;
    z = inverse.cwiseProduct(residual);
    const double rz_next = residual.dot(z);
    p = z + rz_next / rz * p;
    rz = rz_next;
  }
  step *= std::min(1.0, options.longest_step / std::max(1e-300, step.cwiseAbs().maxCoeff()));

  // tries shorter and shorter parts of the step
  for (double length : {1.0, 0.4, 0.1, 0.02}) {
    const Eigen::VectorXd x = state.x + length * step;
    const auto trial = problem->Residuals(x);
    if (!trial || trial->squaredNorm() / variance + prior(x) >= objective) continue;
    next.x = x;
    next.mean_square = trial->squaredNorm() / static_cast<double>(trial->size());
    next.damping = std::clamp(state.damping * (length == 1.0 ? 0.3 : 3.0), 1e-6, 1e3);
    return next;
  }
  next.damping = state.damping * 10;
  next.converged = next.damping > 1e2;
  return next;
}

}  // namespace physpring
