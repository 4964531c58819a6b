// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt for a few parameters: minimises |r(x)|^2 / variance + precision |x|^2 with
// forward differences of the residuals r, which cost one evaluation a parameter (in parallel) and
// need no adjoint. It finds start values; gauss_newton.h goes on with all parameters.
#ifndef PHYSPRING_TRAINER_SOLVERS_LEVENBERG_MARQUARDT_H_
#define PHYSPRING_TRAINER_SOLVERS_LEVENBERG_MARQUARDT_H_

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace physpring {

// Residuals at each of several x (always the same number); nothing where the model cannot be
// evaluated. Called from several threads at once, each with a part of what is asked for: what is
// given for an x must not depend on the others.
using ResidualsFunction = std::function<std::vector<std::optional<Eigen::VectorXd>>(
    const std::vector<Eigen::VectorXd>& xs)>;

// The residuals at each of xs. Each of the threads asks for its share at once.
std::vector<std::optional<Eigen::VectorXd>> EvaluateAll(const ResidualsFunction& residuals,
                                                        const std::vector<Eigen::VectorXd>& xs,
                                                        int threads);

// Which derivatives to take by forward differences, and how.
struct Differences {
  int first, count;   // entries of x
  double difference;  // step
  int threads;
};

// Columns d r / d x_i for these entries, r being the residuals at x; 0 where a step cannot be
// evaluated.
Eigen::MatrixXd DifferenceColumns(const ResidualsFunction& residuals, const Eigen::VectorXd& x,
                                  const Eigen::VectorXd& r, const Differences& differences);

// The prior's precision, 1 / (standard deviation of an entry)^2.
inline constexpr double kLevenbergMarquardtPrecision = 0.25;

struct LevenbergMarquardtOptions {
  double difference = 1e-3;                         // step of the forward differences
  double precision = kLevenbergMarquardtPrecision;  // the prior's of every entry ...
  Eigen::MatrixXd precisions = {};                  // ... or of all, a matrix, if not empty
  double longest_step = 1;                          // no entry of x moves further in one step
  double tolerance = 2e-3;  // converged when a step lowers the objective by less than this share
  // So many times the step goes on with the Jacobian of its start, updated by Broyden's rule, while
  // each time gains a tenth of the first.
  int updates = 0;
  int threads = 1;
};

struct LevenbergMarquardtState {
  Eigen::VectorXd x;
  double damping = 1e-2;
  double mean_square = 0;  // the residuals' mean square at x
  bool converged = false;
};

// One step. The variance is the mean of r^2 at the step's start, so the prior counts as much as
// it would if the misfit were noise of that size. Where no trial is better, x stays and the state
// is converged; also where r(x) does not exist.
// `nearby` (empty: `residuals`) gives the residuals that are differentiated. At state.x it must
// agree with `residuals`; elsewhere it may do what makes them smoother, as keep the number of
// sub-steps.
LevenbergMarquardtState LevenbergMarquardtStep(const ResidualsFunction& residuals,
                                               const LevenbergMarquardtState& state,
                                               const LevenbergMarquardtOptions& options,
                                               const ResidualsFunction& nearby = {});

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_SOLVERS_LEVENBERG_MARQUARDT_H_
