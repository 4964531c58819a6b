// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "twin/parallel.h"

namespace physpring {
namespace {

// The residuals r at x, none where they cannot be evaluated, and columns d r / d x_i by forward
// differences. A parameter whose step cannot be evaluated gets 0: it stays where it is in this
// step.
struct Linearisation {
  std::optional<Eigen::VectorXd> r;
  Eigen::MatrixXd jacobian;
};

Linearisation Linearise(const ResidualsFunction& residuals, const Eigen::VectorXd& x,
                        const LevenbergMarquardtOptions& options) {
  const int count = static_cast<int>(x.size());
  std::vector<Eigen::VectorXd> moved(static_cast<std::size_t>(count) + 1, x);
  for (int i = 0; i < count; ++i) moved[i + 1][i] += options.difference;
  auto at = EvaluateAll(residuals, moved, options.threads);
  Linearisation result = {std::move(at[0]), {}};
  if (!result.r) return result;
  result.jacobian = Eigen::MatrixXd::Zero(result.r->size(), count);
  for (int i = 0; i < count; ++i) {
    if (at[i + 1]) result.jacobian.col(i) = (*at[i + 1] - *result.r) / options.difference;
  }
  return result;
}

// The better of two trials that lower the objective: a step with each of two dampings.
struct Trial {
  Eigen::VectorXd x, r;
  double objective;
  double damping;  // for the next step
};

// What a step minimises: |r|^2 / variance + prior.
class Objective {
 public:
  Objective(const ResidualsFunction& residuals, const LevenbergMarquardtOptions& options,
            double variance, Eigen::Index size)
      : residuals_(residuals),
        options_(options),
        variance_(variance),
        precision_(
            options.precisions.size() > 0
                ? options.precisions
                : Eigen::MatrixXd(options.precision * Eigen::MatrixXd::Identity(size, size))) {}

  double At(const Eigen::VectorXd& r, const Eigen::VectorXd& x) const {
    return r.squaredNorm() / variance_ + x.dot(precision_ * x);
  }

  // Nothing where no trial of up to `attempts` pairs, with more and more damping, is better.
  std::optional<Trial> Try(const Eigen::VectorXd& x, const Eigen::VectorXd& r,
                           const Eigen::MatrixXd& jacobian, double damping, int attempts) const {
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian / variance_ + precision_;
    const Eigen::VectorXd gradient = jacobian.transpose() * r / variance_ + precision_ * x;
    for (int attempt = 0; attempt < attempts; ++attempt, damping *= 30) {
      std::optional<Trial> better = TryPair(x, normal, gradient, damping, At(r, x));
      if (better) return better;
    }
    return {};
  }

 private:
  std::optional<Trial> TryPair(const Eigen::VectorXd& x, const Eigen::MatrixXd& normal,
                               const Eigen::VectorXd& gradient, double damping,
                               double least) const {
    constexpr std::array<double, 2> kFactors = {1, 0.1};
    std::vector<Eigen::VectorXd> tried;
    std::vector<double> next_damping;
    for (double factor : kFactors) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * factor * normal.diagonal();
      Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      step *= std::min(1.0, options_.longest_step / std::max(1e-300, step.cwiseAbs().maxCoeff()));
      if (!step.allFinite()) continue;
      tried.emplace_back(x + step);
      next_damping.push_back(std::clamp(damping * (factor == 1 ? 0.5 : 0.1), 1e-6, 1e6));
    }
    const auto r = EvaluateAll(residuals_, tried, options_.threads);
    std::optional<Trial> better;
    for (std::size_t t = 0; t < tried.size(); ++t) {
      if (!r[t] || At(*r[t], tried[t]) >= least) continue;
      least = At(*r[t], tried[t]);
      better = {tried[t], *r[t], least, next_damping[t]};
    }
    return better;
  }

  const ResidualsFunction& residuals_;
  const LevenbergMarquardtOptions& options_;
  double variance_;
  Eigen::MatrixXd precision_;
};

}  // namespace

std::vector<std::optional<Eigen::VectorXd>> EvaluateAll(const ResidualsFunction& residuals,
                                                        const std::vector<Eigen::VectorXd>& xs,
                                                        int threads) {
  const int count = static_cast<int>(xs.size()), shares = std::min(std::max(threads, 1), count);
  std::vector<std::optional<Eigen::VectorXd>> all(xs.size());
  ParallelFor(shares, threads, [&](int share) {
    const int first = share * count / shares, end = (share + 1) * count / shares;
    auto part = residuals({xs.begin() + first, xs.begin() + end});
    std::move(part.begin(), part.end(), all.begin() + first);
  });
  return all;
}

Eigen::MatrixXd DifferenceColumns(const ResidualsFunction& residuals, const Eigen::VectorXd& x,
                                  const Eigen::VectorXd& r, const Differences& differences) {
  const auto& [first, count, difference, threads] = differences;
  std::vector<Eigen::VectorXd> moved(static_cast<std::size_t>(count), x);
  for (int i = 0; i < count; ++i) moved[i][first + i] += difference;
  const auto at = EvaluateAll(residuals, moved, threads);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(r.size(), count);
  for (int i = 0; i < count; ++i) {
    if (at[i]) columns.col(i) = (*at[i] - r) / difference;
  }
  return columns;
}

LevenbergMarquardtState LevenbergMarquardtStep(const ResidualsFunction& residuals,
                                               const LevenbergMarquardtState& state,
                                               const LevenbergMarquardtOptions& options,
                                               const ResidualsFunction& nearby) {
  constexpr int kAttempts = 4;
  constexpr double kGoesOn = 0.1;  // an update is worth it that gains this share of the first step
  LevenbergMarquardtState next = state;
  next.converged = true;
  auto [r, jacobian] = Linearise(nearby ? nearby : residuals, state.x, options);
  if (!r || r->size() == 0) return next;
  const double count = static_cast<double>(r->size());
  const double variance = std::max(r->squaredNorm() / count, 1e-300);
  next.mean_square = variance;
  const Objective objective(residuals, options, variance, state.x.size());
  const double before = objective.At(*r, state.x);
  double now = before;
  for (int update = 0; update <= options.updates; ++update) {
    const std::optional<Trial> better =
        objective.Try(next.x, *r, jacobian, next.damping, update == 0 ? kAttempts : 1);
    if (!better) break;
    const double gain = now - better->objective;
    const Eigen::VectorXd step = better->x - next.x, change = better->r - *r;
    r = better->r;
    now = better->objective;
    next.x = better->x;
    next.damping = better->damping;
    next.mean_square = r->squaredNorm() / count;
    if (update == options.updates ||
        gain <= std::max(kGoesOn * (before - now), options.tolerance * before)) {
      break;
    }
    // Broyden's update (Math. Comp. 19, 1965): the least change that explains the step
    jacobian += (change - jacobian * step) * (step.transpose() / step.squaredNorm());
  }
  next.converged = before - now < options.tolerance * before;
  return next;
}

}  // namespace physpring
