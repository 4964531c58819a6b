// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/effect_problem.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

constexpr double kLimit = 0.8;

EffectModel MakeModel(const SpringMassSystem& base) {
  ParameterOptions own;
  own.spring_stiffness = own.spring_dashpot = false;
  return EffectModel(Parameters(base, own), {0.5, kLimit},
                     {{"air_drag", Eigen::Vector4d(0.2, 1, 0, 0)},
                      {"tension_only", Eigen::VectorXd::Constant(1, 0.9)}});
}

TEST(EffectModel, IsTheBaseAtZero) {
  const SpringMassSystem base = RandomSystem(25, 2, 1);
  const EffectModel model = MakeModel(base);
  const SpringMassSystem system = model.Apply(Eigen::VectorXd::Zero(model.size()));
  EXPECT_EQ(system.stiffness, base.stiffness);
  ASSERT_EQ(system.effects.size(), 2U);
  EXPECT_EQ(system.effects[0].values, Eigen::Vector4d(0.2, 1, 0, 0));
}

TEST(EffectModel, MovesEvenlyOrByFactorsWithinBounds) {
  const EffectModel model = MakeModel(RandomSystem(25, 2, 1));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.size());
  x.tail(5) << 1, 2, 0, 0, 10;
  const SpringMassSystem system = model.Apply(x);
  EXPECT_DOUBLE_EQ(system.effects[0].values[0], 0.2 * std::exp(1));  // logarithmic
  EXPECT_DOUBLE_EQ(system.effects[0].values[1], 3);                  // 1 m/s a unit
  EXPECT_EQ(system.effects[1].values[0], 1);                         // at most all is slack
}

TEST(EffectModel, MovesItsOwnParametersNoFartherThanTheLimit) {
  const SpringMassSystem base = RandomSystem(25, 2, 1);
  const EffectModel model = MakeModel(base);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.size());
  ASSERT_EQ(model.own().kind(0), Parameters::Kind::kGlobal);
  x[0] = 1e-3;
  const double first = model.Apply(x).stiffness[0] / base.stiffness[0];
  EXPECT_NEAR(std::log(first), 0.5e-3, 1e-9);
  x[0] = 100;
  EXPECT_NEAR(model.Apply(x).stiffness[0], std::exp(kLimit) * base.stiffness[0], 1e-9);
}

TEST(EffectModel, KeepsTheEffectsOfTheBase) {
  SpringMassSystem base = RandomSystem(25, 2, 1);
  base.effects = {{"gravity_direction", Eigen::Vector2d(0.1, 0)}};
  const EffectModel model = MakeModel(base);
  const SpringMassSystem system = model.Apply(Eigen::VectorXd::Constant(model.size(), 0.1));
  ASSERT_EQ(system.effects.size(), 3U);
  EXPECT_EQ(system.effects[0].values, base.effects[0].values);
  EXPECT_EQ(system.effects[1].name, "air_drag");
}

// The adjoint J^T u and the differences J v of the whole problem: u . J v = J^T u . v; with an
// effect of the base, too.
class AdjointOfTheProblem : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(BaseHasAnEffect, AdjointOfTheProblem, testing::Bool());

TEST_P(AdjointOfTheProblem, IsTransposedToItsDifferences) {
  Random random(2);
  SpringMassSystem base = RandomSystem(25, 2, 1);
  if (GetParam()) base.effects = {{"gravity_direction", Eigen::Vector2d(0.1, 0)}};
  Recording recording;
  recording.fps = 50;
  recording.start = base.position;
  recording.velocity = Points::Zero(3, 25);
  for (int t = 0; t < 6; ++t) {
    recording.points.emplace_back(base.position.leftCols(25) + random.Box(25, 0.01));
    recording.controllers.emplace_back(base.position.rightCols(2) + t * random.Box(2, 0.002));
  }
  std::vector<SplitRecording> split{
      {&recording, std::vector<SplitRecording::Use>(6, SplitRecording::Use::kFit)}};
  split[0].use[0] = SplitRecording::Use::kNone;
  split[0].use[3] = SplitRecording::Use::kHeld;
  EffectProblem problem(MakeModel(base), split, {});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.model().size());
  x.head(problem.model().own().size()).setConstant(0.7);
  x[x.size() - 1] = -1;  // away from the bound
  const auto r = problem.Linearise(x);
  ASSERT_TRUE(r);
  EXPECT_EQ(r->size(), 3 * 25 * 4);
  Eigen::VectorXd u(r->size()), v(x.size());
  for (double& value : u) value = random(-1, 1);
  for (double& value : v) value = random(-1, 1);
  const double forward = u.dot(problem.JacobianTimes(v));
  // forward differences over 1e-5
  EXPECT_NEAR(problem.JacobianTransposedTimes(u).dot(v), forward, 1e-3 * std::abs(forward));
}

}  // namespace
}  // namespace physpring
