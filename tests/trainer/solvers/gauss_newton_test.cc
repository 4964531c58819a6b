// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/gauss_newton.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

// r(x) = A x - b, which cannot be evaluated where x[0] > limit.
class Linear : public LeastSquares {
 public:
  explicit Linear(double limit = 1e9) : limit_(limit), a_(9, 4), b_(9) {
    Random random(11);
    for (double& entry : a_.reshaped()) entry = random(-1, 1);
    for (double& entry : b_) entry = random(-1, 1);
  }
  std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd& x) override {
    if (x[0] > limit_) return {};
    return a_ * x - b_;
  }
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) override {
    return Residuals(x);
  }
  Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) override { return a_ * v; }
  Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) override {
    return a_.transpose() * u;
  }
  Eigen::VectorXd Solution() const { return a_.colPivHouseholderQr().solve(b_); }

 private:
  double limit_;
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
};

// Linear, but only the point of linearisation itself can be evaluated: every trial fails.
class OnlyHere : public Linear {
 public:
  std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd&) override { return {}; }
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) override {
    return Linear::Residuals(x);
  }
};

GaussNewtonOptions Options(double precision) {
  GaussNewtonOptions options;
  options.precision = Eigen::VectorXd::Constant(4, precision);
  options.scale = Eigen::Vector4d(1, 10, 1, 0.1);
  return options;
}

GaussNewtonState Steps(LeastSquares* problem, GaussNewtonState state,
                       const GaussNewtonOptions& options, int count) {
  for (int i = 0; i < count; ++i) state = GaussNewtonStep(problem, state, options);
  return state;
}

TEST(GaussNewton, SolvesALinearProblem) {
  Linear problem;
  const auto end = Steps(&problem, {Eigen::VectorXd::Zero(4)}, Options(0), 12);
  EXPECT_LT((end.x - problem.Solution()).norm(), 1e-6);
  EXPECT_NEAR(end.mean_square, problem.Residuals(problem.Solution())->squaredNorm() / 9, 1e-9);
}

// At the end the gradient of |r|^2 / variance + precision |x|^2, variance fixed, is zero.
TEST(GaussNewton, PriorHoldsEntriesNearZero) {
  Linear problem;
  const double precision = 3;
  const auto end = Steps(&problem, {Eigen::VectorXd::Zero(4)}, Options(precision), 25);
  const Eigen::VectorXd gradient =
      problem.JacobianTransposedTimes(*problem.Residuals(end.x)) / end.mean_square +
      precision * end.x;
  EXPECT_LT(gradient.norm(), 1e-5);
  EXPECT_LT(end.x.norm(), problem.Solution().norm());
  EXPECT_GT(end.x.norm(), 0.01);
}

TEST(GaussNewton, NoEntryMovesFurtherThanTheLongestStep) {
  Linear problem;
  GaussNewtonOptions options = Options(0);
  options.longest_step = 0.01;
  const auto state = GaussNewtonStep(&problem, {Eigen::VectorXd::Zero(4)}, options);
  EXPECT_NEAR(state.x.cwiseAbs().maxCoeff(), 0.01, 1e-12);
}

TEST(GaussNewton, TakesAShorterStepWhereTheWholeOneCannotBeEvaluated) {
  Linear free;
  const GaussNewtonState start{free.Solution() - Eigen::Vector4d(0.3, 0, 0, 0)};
  const Eigen::VectorXd step = GaussNewtonStep(&free, start, Options(0)).x - start.x;
  ASSERT_GT(step[0], 0.1);
  Linear walled(start.x[0] + 0.5 * step[0]);
  const auto state = GaussNewtonStep(&walled, start, Options(0));
  EXPECT_LT((state.x - start.x - 0.4 * step).norm(), 1e-12);
  EXPECT_GT(state.damping, start.damping);
}

TEST(GaussNewton, DoesNotMoveWhereNothingIsBetter) {
  OnlyHere problem;
  GaussNewtonState state{Eigen::Vector4d(0.1, 0.2, 0.3, 0.4)};
  const Eigen::VectorXd start = state.x;
  int steps = 0;
  for (; !state.converged && steps < 20; ++steps) {
    state = GaussNewtonStep(&problem, state, Options(1));
    ASSERT_EQ(state.x, start);
  }
  EXPECT_TRUE(state.converged);
  EXPECT_GT(steps, 1);  // tries stronger dampings first
}

TEST(GaussNewton, StaysWhereResidualsDoNotExist) {
  Linear problem(-1);
  const GaussNewtonState start{Eigen::VectorXd::Zero(4)};
  const auto state = GaussNewtonStep(&problem, start, Options(0));
  EXPECT_EQ(state.x, start.x);
  EXPECT_TRUE(state.converged);
}

}  // namespace
}  // namespace physpring
