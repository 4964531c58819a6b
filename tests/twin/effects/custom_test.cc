// SPDX-License-Identifier: Apache-2.0
// All terms of a law: their derivatives inside the simulator, and their forces by the formulas of
// custom.cc.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/targeted_rollout.h"
#include "twin/effects/registry.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kRate = 20;  // rad/s
constexpr double kStep = 1e-3;

// The values of a term; its course is of about the size `size` within the rollout of 0.1 s or so.
EffectValues Term(int acts_on, int in_time, double size) {
  const double scale[] = {1, 10, 100, 1};
  Eigen::VectorXd values(9);
  values << acts_on, in_time, kRate, 0.5, -0.3, 0.4, -0.2, 0.6, 0.3;
  values.tail(6) *= size * scale[in_time];
  return {"custom", values};
}

class CustomTerms : public testing::TestWithParam<std::tuple<int, int>> {
 protected:
  CustomTerms() {
    const auto [acts_on, in_time] = GetParam();
    const double size[] = {20, 300, 20, 1, 3};
    rollout.system.effects = {Term(acts_on, in_time, size[acts_on])};
  }

  TargetedRollout rollout = RandomRollout(4, 1);
};

TEST_P(CustomTerms, HaveTheDerivativesThatDifferencesShow) {
  const RolloutGradient gradient = Gradient<double>(rollout);
  Eigen::VectorXd& values = rollout.system.effects[0].values;
  std::vector<CheckedVariable> variables;
  for (Eigen::Index i = 2; i < values.size(); ++i) {
    variables.push_back({std::to_string(i), &values[i], kStep * std::abs(values[i]),
                         gradient.system.effects[0][i]});
  }
  const GradientReport report = CheckGradient([&] { return Loss<double>(rollout); }, variables);
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_GT(gradient.system.effects[0].norm(), 0);
}

TEST_P(CustomTerms, KeepTheOtherDerivativesRight) {
  for (const GradientReport& report : CheckRollout(rollout, kStep)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

INSTANTIATE_TEST_SUITE_P(All, CustomTerms,
                         testing::Combine(testing::Range(0, 5), testing::Range(0, 4)),
                         [](const auto& test) {
                           return std::to_string(std::get<0>(test.param)) + "_" +
                                  std::to_string(std::get<1>(test.param));
                         });

// What a term of nodes exerts at one moment.
Points ForceOf(const EffectValues& effect, const SpringMassSystem& system, double time,
               const Points& x, const Points& v) {
  const auto force = GetEffect("custom").MakeForce(system, effect.values);
  Points sum = Points::Zero(3, x.cols());
  Eigen::VectorXd internal(0);
  force->Add({time, 1e-3, x, v, {}}, internal, &sum);
  return sum;
}

TEST(CustomTerm, ExertsItsFormula) {
  const TargetedRollout rollout = RandomRollout(1, 3);
  const SpringMassSystem& system = rollout.system;
  const int nodes = system.node_count();
  const Eigen::Vector3d a(0.5, -0.3, 0.4), b(-0.2, 0.6, 0.3);
  const Eigen::Vector3d middle = system.position.leftCols(nodes).rowwise().mean();
  const Points x = system.position.array() + 0.01, v = Points::Constant(3, x.cols(), 0.3);
  constexpr double kTime = 0.7;
  const Points growing = ForceOf(Term(0, 1, 0.1), system, kTime, x, v);
  const Points place = ForceOf(Term(1, 3, 1), system, kTime, x, v);
  const Points velocity = ForceOf(Term(2, 2, 0.01), system, kTime, x, v);
  const Eigen::Vector3d wave = std::sin(kRate * kTime) * a + std::cos(kRate * kTime) * b;
  for (int i = 0; i < nodes; ++i) {
    const double m = system.mass[i];
    EXPECT_TRUE(growing.col(i).isApprox(m * kTime * a, 1e-12));
    EXPECT_TRUE(place.col(i).isApprox(m * wave.cwiseProduct(x.col(i) - middle), 1e-12));
    EXPECT_TRUE(velocity.col(i).isApprox(m * kTime * kTime * a.cwiseProduct(v.col(i)), 1e-12));
  }
}

TEST(CustomTerm, OfTheStretchStaysWithinWhatIsStable) {
  SpringMassSystem system = RandomRollout(1, 3).system;
  const double before = ComputeStabilityBound(system).timestep;
  system.effects = {Term(3, 2, 1000)};  // far beyond four times the stiffness
  const double after = ComputeStabilityBound(system).timestep;
  EXPECT_LT(after, before);
  EXPECT_GT(after, before / std::sqrt(5.0) * 0.99);
}

}  // namespace
}  // namespace physpring
