// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <utility>

namespace physpring {
namespace {

const LevenbergMarquardtOptions kNoPrior{.precision = 0};

// Residuals at one x.
using ResidualFunction = std::function<std::optional<Eigen::VectorXd>(const Eigen::VectorXd& x)>;

ResidualsFunction OneByOne(ResidualFunction residuals) {
  if (!residuals) return {};
  return [residuals = std::move(residuals)](const std::vector<Eigen::VectorXd>& xs) {
    std::vector<std::optional<Eigen::VectorXd>> all;
    for (const Eigen::VectorXd& x : xs) all.push_back(residuals(x));
    return all;
  };
}

LevenbergMarquardtState Step(const ResidualFunction& residuals,
                             const LevenbergMarquardtState& state,
                             const LevenbergMarquardtOptions& options,
                             const ResidualFunction& nearby = {}) {
  return LevenbergMarquardtStep(OneByOne(residuals), state, options, OneByOne(nearby));
}

// r_i = a exp(-b t_i) - 2 exp(-0.7 t_i): zero at (a, b) = (2, 0.7).
std::optional<Eigen::VectorXd> Decay(const Eigen::VectorXd& x) {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(10, 0, 3);
  return Eigen::VectorXd(x[0] * (-x[1] * t).exp() - 2 * (-0.7 * t).exp());
}

// One step, hardly damped, of r = x - (2, 2) from x = 0.
LevenbergMarquardtState LinearStep(const LevenbergMarquardtOptions& options) {
  LevenbergMarquardtState start{Eigen::Vector2d(0, 0)};
  start.damping = 1e-6;
  return Step(
      [](const Eigen::VectorXd& x) {
        return std::optional<Eigen::VectorXd>(x - Eigen::Vector2d(2, 2));
      },
      start, options);
}

LevenbergMarquardtState Steps(const ResidualFunction& residuals, LevenbergMarquardtState state,
                              const LevenbergMarquardtOptions& options, int most) {
  for (int i = 0; i < most && !state.converged; ++i) {
    state = Step(residuals, state, options);
  }
  return state;
}

TEST(LevenbergMarquardt, SolvesANonlinearProblem) {
  const LevenbergMarquardtState end = Steps(Decay, {Eigen::Vector2d(0.5, -0.3)}, kNoPrior, 15);
  EXPECT_NEAR(end.x[0], 2, 1e-6);
  EXPECT_NEAR(end.x[1], 0.7, 1e-6);
  EXPECT_LT(end.mean_square, 1e-12);
}

TEST(LevenbergMarquardt, GivesTheSameBitsForAnyNumberOfThreads) {
  LevenbergMarquardtOptions options;
  const LevenbergMarquardtState one = Steps(Decay, {Eigen::Vector2d(0.5, 0)}, options, 4);
  options.threads = 2;
  EXPECT_EQ(one.x, Steps(Decay, {Eigen::Vector2d(0.5, 0)}, options, 4).x);
}

TEST(LevenbergMarquardt, AsksForDifferencesAtOnceAndForEachThreadsShare) {
  std::mutex lock;
  std::vector<std::size_t> asked;
  const auto counted = [&](const std::vector<Eigen::VectorXd>& xs) {
    const std::lock_guard guard(lock);
    asked.push_back(xs.size());
    return OneByOne(Decay)(xs);
  };
  LevenbergMarquardtOptions options;
  LevenbergMarquardtStep(counted, {Eigen::Vector2d(0.5, 0)}, options);
  EXPECT_EQ(asked, (std::vector<std::size_t>{3, 2}));  // the differences, and two trials
  asked.clear();
  options.threads = 2;
  LevenbergMarquardtStep(counted, {Eigen::Vector2d(0.5, 0)}, options);
  std::sort(asked.begin(), asked.end());
  EXPECT_EQ(asked, (std::vector<std::size_t>{1, 1, 1, 2}));
}

TEST(LevenbergMarquardt, NoEntryMovesFurtherThanTheLongestStep) {
  const auto far = [](const Eigen::VectorXd& x) {
    return std::optional<Eigen::VectorXd>(x - Eigen::Vector2d(10, 0));
  };
  const auto state = Step(far, {Eigen::Vector2d(0, 0)}, kNoPrior);
  EXPECT_NEAR(state.x[0], 1, 1e-9);
}

// r = x - (2, 2) with variance 4 at x = 0: (x - 2) / 4 + precision x = 0.
TEST(LevenbergMarquardt, PriorCountsAgainstTheMisfitAtTheStart) {
  LevenbergMarquardtOptions options{.precision = 0.75, .longest_step = 10};
  const LevenbergMarquardtState state = LinearStep(options);
  EXPECT_NEAR(state.x[0], 0.5, 1e-5);
  EXPECT_NEAR(state.x[1], 0.5, 1e-5);
}

TEST(LevenbergMarquardt, EachEntryMayHaveAPriorOfItsOwn) {
  LevenbergMarquardtOptions options{.longest_step = 10};
  options.precisions = Eigen::Vector2d(0.75, 0.25).asDiagonal();
  const LevenbergMarquardtState state = LinearStep(options);
  EXPECT_NEAR(state.x[0], 0.5, 1e-5);
  EXPECT_NEAR(state.x[1], 1, 1e-5);
}

// With a precision of (x_0 - x_1)^2 as well, (x - 2) / 4 + P x = 0 has the solution below.
TEST(LevenbergMarquardt, PriorMayTieEntriesToEachOther) {
  LevenbergMarquardtOptions options{.longest_step = 10};
  options.precisions = Eigen::Vector2d(0.75, 0.25).asDiagonal();
  options.precisions += (Eigen::Matrix2d() << 1, -1, -1, 1).finished();
  const LevenbergMarquardtState state = LinearStep(options);
  const Eigen::Matrix2d normal = 0.25 * Eigen::Matrix2d::Identity() + options.precisions;
  EXPECT_LT((state.x - normal.inverse() * Eigen::Vector2d(0.5, 0.5)).norm(), 1e-5);
}

TEST(LevenbergMarquardt, GoesOnWithAnUpdatedJacobianForTwoEvaluationsEach) {
  const LevenbergMarquardtState start{Eigen::Vector2d(0.5, -0.3)};
  LevenbergMarquardtOptions options{.precision = 0};
  int calls = 0;
  const auto counted = [&](const Eigen::VectorXd& x) {
    ++calls;
    return Decay(x);
  };
  const double once = Step(counted, start, options).mean_square;
  const int calls_of_one = calls;
  calls = 0;
  options.updates = 3;
  const double updated = Step(counted, start, options).mean_square;
  EXPECT_LT(updated, 0.8 * once);
  EXPECT_GT(calls, calls_of_one);
  EXPECT_LE(calls, calls_of_one + 3 * 2);
}

TEST(LevenbergMarquardt, DifferentiatesWhatItIsToldTo) {
  // to differences, the second entry does nothing
  const auto blind = [](const Eigen::VectorXd& x) { return Decay(Eigen::Vector2d(x[0], 0)); };
  const LevenbergMarquardtState start{Eigen::Vector2d(0.5, 0)};
  const LevenbergMarquardtOptions options{.precision = 1e-9};
  EXPECT_NE(Step(Decay, start, options).x[1], 0);
  const auto state = Step(Decay, start, options, blind);
  EXPECT_NE(state.x[0], 0.5);
  EXPECT_EQ(state.x[1], 0);
}

TEST(LevenbergMarquardt, StaysWhereResidualsDoNotExist) {
  const auto nowhere = [](const Eigen::VectorXd&) { return std::optional<Eigen::VectorXd>(); };
  const auto state = Step(nowhere, {Eigen::Vector2d(1, 2)}, kNoPrior);
  EXPECT_EQ(state.x, Eigen::Vector2d(1, 2));
  EXPECT_TRUE(state.converged);
}

TEST(LevenbergMarquardt, KeepsOutOfWhereResidualsDoNotExist) {
  const auto walled = [](const Eigen::VectorXd& x) {
    return x[0] > 1 ? std::optional<Eigen::VectorXd>() : Decay(x);
  };
  const LevenbergMarquardtState start{Eigen::Vector2d(0.5, 0)};
  const LevenbergMarquardtState end = Steps(walled, start, kNoPrior, 20);
  EXPECT_LE(end.x[0], 1);
  EXPECT_LT(walled(end.x)->squaredNorm(), 0.5 * walled(start.x)->squaredNorm());
}

TEST(LevenbergMarquardt, ParameterWhoseDifferenceDoesNotExistStaysInPlace) {
  const auto walled = [](const Eigen::VectorXd& x) {
    return x[0] > 1 ? std::optional<Eigen::VectorXd>() : Decay(x);
  };
  LevenbergMarquardtOptions options;
  options.precision = 1e-9;
  const auto state = Step(walled, {Eigen::Vector2d(1, 0)}, options);
  EXPECT_NEAR(state.x[0], 1, 0.3);  // the prior alone moves it
  EXPECT_NE(state.x[1], 0);
}

TEST(LevenbergMarquardt, DoesNotMoveWhereNothingIsBetter) {
  // any move away from (1, 1) raises the residuals
  const auto cusp = [](const Eigen::VectorXd& x) {
    return std::optional<Eigen::VectorXd>(
        Eigen::VectorXd::Constant(1, 1 + (x - Eigen::Vector2d(1, 1)).cwiseAbs().sum()));
  };
  const auto state = Step(cusp, {Eigen::Vector2d(1, 1)}, kNoPrior);
  EXPECT_EQ(state.x, Eigen::Vector2d(1, 1));
  EXPECT_TRUE(state.converged);
}

}  // namespace
}  // namespace physpring
