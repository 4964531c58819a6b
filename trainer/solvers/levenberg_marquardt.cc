// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "trainer/solvers/parallel.h"

namespace physpring {
namespace {

// The residuals r at x, none where they cannot be evaluated, and columns d r / d x_i by forward
// differences. A parameter whose step cannot be evaluated gets 0: it stays where it is in this
// step.
struct Linearisation {
  std::optional<Eigen::VectorXd> r;
  Eigen::MatrixXd jacobian;
};

Linearisation Linearise(const ResidualFunction& residuals, const Eigen::VectorXd& x,
                        const LevenbergMarquardtOptions& options) {
  const int count = static_cast<int>(x.size());
  std::vector<std::optional<Eigen::VectorXd>> at(static_cast<std::size_t>(count) + 1);
  ParallelFor(count + 1, options.threads, [&](int i) {
    Eigen::VectorXd moved = x;
    if (i > 0) moved[i - 1] += options.difference;
    at[i] = residuals(moved);
  });
  Linearisation result = {std::move(at[0]), {}};
  if (!result.r) return result;
  result.jacobian = Eigen::MatrixXd::Zero(result.r->size(), count);
  for (int i = 0; i < count; ++i) {
    if (at[i + 1]) result.jacobian.col(i) = (*at[i + 1] - *result.r) / options.difference;
  }
  return result;
}

}  // namespace

LevenbergMarquardtState LevenbergMarquardtStep(const ResidualFunction& residuals,
                                               const LevenbergMarquardtState& state,
                                               const LevenbergMarquardtOptions& options) {
  LevenbergMarquardtState next = state;
  next.converged = true;
  const auto [r, jacobian] = Linearise(residuals, state.x, options);
  if (!r || r->size() == 0) return next;
  const double count = static_cast<double>(r->size());
  const double variance = std::max(r->squaredNorm() / count, 1e-300);
  next.mean_square = variance;
  const auto objective = [&](const Eigen::VectorXd& residual, const Eigen::VectorXd& x) {
    return residual.squaredNorm() / variance + options.precision * x.squaredNorm();
  };
  const double before = objective(*r, state.x);
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian / variance;
  normal.diagonal().array() += options.precision;
  const Eigen::VectorXd gradient =
      jacobian.transpose() * *r / variance + options.precision * state.x;

  double damping = state.damping;
  for (int attempt = 0; attempt < 4; ++attempt, damping *= 30) {
    // two dampings at once; the better one counts
    constexpr std::array<double, 2> kFactors = {1, 0.1};
    std::array<Eigen::VectorXd, 2> x;
    std::array<std::optional<Eigen::VectorXd>, 2> trial;
    ParallelFor(2, options.threads, [&](int t) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * kFactors[t] * normal.diagonal();
      Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      step *= std::min(1.0, options.longest_step / std::max(1e-300, step.cwiseAbs().maxCoeff()));
      x[t] = state.x + step;
      if (x[t].allFinite()) trial[t] = residuals(x[t]);
    });
    double best = before;
    for (int t = 0; t < 2; ++t) {
      if (!trial[t] || objective(*trial[t], x[t]) >= best) continue;
      best = objective(*trial[t], x[t]);
      next.x = x[t];
      next.mean_square = trial[t]->squaredNorm() / count;
      next.damping = std::clamp(damping * (t == 0 ? 0.5 : 0.1), 1e-6, 1e6);
    }
    if (best < before) {
      next.converged = before - best < options.tolerance * before;
      return next;
    }
  }
  return next;
}

}  // namespace physpring
