// SPDX-License-Identifier: Apache-2.0
// Matrix-free Gauss-Newton (Levenberg-Marquardt) for many parameters: minimises
//   |r(x)|^2 / variance + sum_i precision_i x_i^2.
// Each step solves (J^T J / variance + P + damping D) s = -gradient by conjugate gradients. J v
// comes from a difference of residuals along v (one rollout), J^T u from the adjoint.
#ifndef PHYSPRING_TRAINER_SOLVERS_GAUSS_NEWTON_H_
#define PHYSPRING_TRAINER_SOLVERS_GAUSS_NEWTON_H_

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace physpring {

// A model with residuals r(x), linearised at the point where it was last evaluated by Linearise.
class LeastSquares {
 public:
  virtual ~LeastSquares() = default;
  // Residuals at x; nothing where the model cannot be evaluated.
  virtual std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd& x) = 0;
  // Takes x as the point of linearisation and returns r(x).
  virtual std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) = 0;
  virtual Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) = 0;
  virtual Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) = 0;
};

struct GaussNewtonState {
  Eigen::VectorXd x;
  double damping = 1e-2;   // relative to `scale`
  double mean_square = 0;  // the residuals' mean square at x
  bool converged = false;
};

struct GaussNewtonOptions {
  int conjugate_gradient_steps = 20;
  double longest_step = 0.7;  // no entry of x moves further in one step
  Eigen::VectorXd precision;  // P, the prior's
  Eigen::VectorXd scale;      // D: how strongly each entry acts, relative to the others
};

// A step that leaves more of the mean square than this gains little, and so many in a row end a
// fit.
constexpr double kSlowStep = 0.99;
constexpr int kMostSlowSteps = 2;

// One step, with r^2's mean at the start as variance. Returns the new state (the old x with
// `converged` where no trial was better).
GaussNewtonState GaussNewtonStep(LeastSquares* problem, const GaussNewtonState& state,
                                 const GaussNewtonOptions& options);

// Whether a fit ends with this step: stronger dampings hardly ever help where no length of a step
// did, except at the start.
inline bool IsStuck(const GaussNewtonState& before, const GaussNewtonState& after, bool first) {
  return after.converged || (!first && after.x == before.x);
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_SOLVERS_GAUSS_NEWTON_H_
