// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/parameters.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"

namespace physpring {
namespace {

const ParameterOptions kAll{true, true, true, true};
const ParameterOptions kCommon{false, false, false, false};

Eigen::VectorXd Uniform(int size, double bound, Random* random) {
  Eigen::VectorXd values(size);
  for (double& value : values) value = (*random)(-bound, bound);
  return values;
}

// A loss that is linear in every quantity of the system: its gradient is known.
SystemGradient RandomWeights(const SpringMassSystem& system) {
  Random random(5);
  SystemGradient weights(system);
  weights.stiffness = Uniform(system.spring_count(), 1, &random);
  weights.dashpot = Uniform(system.spring_count(), 100, &random);
  weights.rest_length = Uniform(system.spring_count(), 100, &random);
  weights.drag = 20;
  weights.contact.surface.restitution = 30;
  weights.contact.surface.friction = -40;
  return weights;
}

long double LinearLoss(const SystemGradient& weights, const SpringMassSystem& system) {
  long double sum = 0;
  for (int e = 0; e < system.spring_count(); ++e) {
    sum += static_cast<long double>(weights.stiffness[e]) * system.stiffness[e];
    sum += static_cast<long double>(weights.dashpot[e]) * system.dashpot[e];
    sum += static_cast<long double>(weights.rest_length[e]) * system.rest_length[e];
  }
  sum += static_cast<long double>(weights.drag) * system.drag;
  const ContactPair<double>& surface = weights.contact.surface;
  sum += static_cast<long double>(surface.restitution) * system.contact.surface.restitution;
  return sum + static_cast<long double>(surface.friction) * system.contact.surface.friction;
}

// The number of classes, from the number of values that the common factors alone have.
int Classes(const SpringMassSystem& base) { return (Parameters(base, kCommon).size() - 5) / 2; }

// A chain along x with springs of these lengths.
SpringMassSystem Chain(const std::vector<double>& lengths) {
  Points position = Points::Zero(3, static_cast<Eigen::Index>(lengths.size()) + 1);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    position(0, static_cast<int>(i) + 1) = position(0, static_cast<int>(i)) + lengths[i];
  }
  SpringMassSystem chain = Particles(position, 0.01);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    AddSpring(static_cast<int>(i), static_cast<int>(i) + 1, 10, lengths[i], 0.1, &chain);
  }
  return chain;
}

// With classes that differ little in length, dashpots by their loss times, and a field of two
// modes.
ParameterOptions Smooth(bool own) {
  ParameterOptions options{own, own, own, true};
  options.loss_times = true;
  options.classes.jump = 1.2;
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  Random random(11);
  options.modes.resize(base.spring_count(), 2);
  for (double& value : options.modes.reshaped()) value = random(-1, 1);
  return options;
}

class ParametersAdjoint : public testing::TestWithParam<ParameterOptions> {};

TEST_P(ParametersAdjoint, AgreesWithDifferences) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  const Parameters parameters(base, GetParam());
  Random random(7);
  Eigen::VectorXd values = Uniform(parameters.size(), 0.5, &random);
  const SystemGradient weights = RandomWeights(base);
  const Eigen::VectorXd bar = parameters.Adjoint(values, parameters.Apply(values), weights);
  ASSERT_EQ(bar.size(), parameters.size());
  std::vector<CheckedVariable> variables;
  for (int i = 0; i < parameters.size(); ++i) {
    variables.push_back({"value " + std::to_string(i), &values[i], 1e-2, bar[i]});
  }
  const auto loss = [&] { return LinearLoss(weights, parameters.Apply(values)); };
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_LE(report.worst_error, 1e-6);
}

// Of three effects the last two are free: their values move within bounds, the first one's do not.
TEST(Parameters, LastEffectsHaveTheDerivativesThatDifferencesShow) {
  SpringMassSystem base = RandomSystem(10, 2, 3);
  base.effects = {{"stiffening", Eigen::VectorXd::Constant(1, 3)},
                  {"bending_friction", Eigen::Vector2d(1e-3, 900)},
                  {"gravity_direction", Eigen::Vector2d(0.1, 0)}};
  ParameterOptions options = kCommon;
  options.free_effects = 2;
  const Parameters parameters(base, options);
  ASSERT_EQ(parameters.effect_count(), 4);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(parameters.size());
  values.tail(4) << 0.3, 0.5, -0.2, 0.4;  // the second one is beyond its bound
  SystemGradient weights(base);
  weights.effects = {Eigen::VectorXd::Constant(1, 7), Eigen::Vector2d(2000, 5),
                     Eigen::Vector2d(-3, 4)};
  const SpringMassSystem system = parameters.Apply(values);
  EXPECT_EQ(system.effects[0].values[0], 3);
  EXPECT_EQ(system.effects[1].values[1], 1000);
  const Eigen::VectorXd bar = parameters.Adjoint(values, system, weights);
  const auto loss = [&] {
    long double sum = 0;
    const SpringMassSystem at = parameters.Apply(values);
    for (std::size_t i = 0; i < 3; ++i) {
      sum += static_cast<long double>(weights.effects[i].dot(at.effects[i].values));
    }
    return sum;
  };
  std::vector<CheckedVariable> variables;
  for (int i = parameters.effects(); i < parameters.size(); ++i) {
    variables.push_back({"value " + std::to_string(i), &values[i], 1e-2, bar[i]});
  }
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
}

TEST(Parameters, DashpotsThatAreNotFreeStayAndPassNoDerivative) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  ParameterOptions options = kCommon;
  options.dashpots = false;
  const Parameters parameters(base, options);
  const Eigen::VectorXd values = Eigen::VectorXd::Constant(parameters.size(), 0.3);
  const SpringMassSystem system = parameters.Apply(values);
  EXPECT_EQ(system.dashpot, base.dashpot);
  const Eigen::VectorXd bar = parameters.Adjoint(values, system, RandomWeights(base));
  EXPECT_EQ(bar[2], 0);
  EXPECT_EQ(bar[3], 0);
  EXPECT_NE(bar[0], 0);
}

TEST(Parameters, SpringsWithoutClassesHaveOne) {
  ParameterOptions options = kCommon;
  options.length_classes = false;
  EXPECT_EQ(Parameters(Chain({0.01, 0.02, 0.03}), options).size(), 5 + 2);
}

INSTANTIATE_TEST_SUITE_P(Options, ParametersAdjoint,
                         testing::Values(kAll, kCommon, ParameterOptions{true, false, false, false},
                                         ParameterOptions{false, true, false, true},
                                         ParameterOptions{true, false, true, false, 0, 1, true,
                                                          true, true},
                                         Smooth(false), Smooth(true)));

TEST(Parameters, DashpotsFollowStiffnessesWhereTheirLossTimesAreFitted) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  const Parameters parameters(base, Smooth(false));
  Eigen::VectorXd values = Eigen::VectorXd::Zero(parameters.size());
  values[0] = values[1] = std::log(3.0);  // all stiffnesses
  values[2] = std::log(2.0);              // loss times of springs between particles
  const SpringMassSystem system = parameters.Apply(values);
  for (int e = 0; e < base.spring_count(); ++e) {
    const bool hand = base.springs[e][1] >= base.node_count();
    EXPECT_NEAR(system.dashpot[e] / base.dashpot[e], hand ? 3 : 6, 1e-12) << e;
  }
}

TEST(Parameters, ModesMoveTheStiffnessOfAllSprings) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  const ParameterOptions options = Smooth(false);
  const Parameters parameters(base, options);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(parameters.size());
  const int mode = parameters.size() - 1;  // there are no effects
  ASSERT_EQ(parameters.kind(mode), Parameters::Kind::kMode);
  values[mode] = 0.5;
  const SpringMassSystem system = parameters.Apply(values);
  for (int e = 0; e < base.spring_count(); ++e) {
    EXPECT_NEAR(system.stiffness[e] / base.stiffness[e], std::exp(0.5 * options.modes(e, 1)),
                1e-12);
  }
}

TEST(Parameters, ZeroIsTheBaseSystem) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  const Parameters parameters(base, kAll);
  const SpringMassSystem system = parameters.Apply(Eigen::VectorXd::Zero(parameters.size()));
  EXPECT_EQ(system.stiffness, base.stiffness);
  EXPECT_EQ(system.dashpot, base.dashpot);
  EXPECT_EQ(system.rest_length, base.rest_length);
  EXPECT_EQ(system.drag, base.drag);
  EXPECT_NEAR(system.contact.surface.restitution, base.contact.surface.restitution, 1e-12);
  EXPECT_NEAR(system.contact.surface.friction, base.contact.surface.friction, 1e-12);
}

TEST(Parameters, EveryEntryHasItsKind) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  const Parameters parameters(base, kAll);
  const int springs = base.spring_count();
  const int globals = parameters.size() - 3 * springs;
  EXPECT_EQ(globals, 7 + 2 * Classes(base));
  using Kind = Parameters::Kind;
  EXPECT_EQ(parameters.kind(0), Kind::kGlobal);
  EXPECT_EQ(parameters.kind(globals - Classes(base) - 1), Kind::kGlobal);
  EXPECT_EQ(parameters.kind(globals - Classes(base)), Kind::kClassDashpot);
  EXPECT_EQ(parameters.kind(globals - 1), Kind::kClassDashpot);
  EXPECT_EQ(parameters.kind(globals), Kind::kStiffness);
  EXPECT_EQ(parameters.kind(globals + springs), Kind::kDashpot);
  EXPECT_EQ(parameters.kind(globals + 3 * springs - 1), Kind::kRestLength);
}

TEST(Parameters, ControllerSpringsHaveAFactorOfTheirOwn) {
  const SpringMassSystem base = RandomSystem(10, 2, 3);
  const Parameters parameters(base, kCommon);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(parameters.size());
  values[1] = std::log(2.0);  // controllers' stiffness
  const SpringMassSystem system = parameters.Apply(values);
  for (int e = 0; e < base.spring_count(); ++e) {
    const bool hand = base.springs[e][1] >= base.node_count();
    EXPECT_NEAR(system.stiffness[e], (hand ? 2 : 1) * base.stiffness[e], 1e-12 * 120) << e;
  }
}

TEST(Parameters, ContactStaysInItsRange) {
  const Parameters parameters(RandomSystem(10, 2, 3), kAll);
  for (double far : {-50.0, 50.0}) {
    const ContactCoefficients contact =
        parameters.Apply(Eigen::VectorXd::Constant(parameters.size(), far)).contact;
    EXPECT_NEAR(contact.surface.restitution, far > 0 ? 1 : 0, 1e-9);
    EXPECT_NEAR(contact.surface.friction, far > 0 ? 2 : 0, 1e-9);
  }
}

TEST(Parameters, SpringsOfAboutEqualLengthAreOneClass) {
  const SpringMassSystem chain = Chain({0.0100, 0.0141, 0.0102, 0.0142, 0.02, 0.0101});
  EXPECT_EQ(Classes(chain), 3);
  const Parameters parameters(chain, kCommon);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(parameters.size());
  values[5] = std::log(3.0);  // the class of the shortest
  const Eigen::VectorXd factor = parameters.Apply(values).stiffness / 10;
  Eigen::VectorXd expected(6);
  expected << 3, 1, 3, 1, 1, 3;
  EXPECT_LT((factor - expected).norm(), 1e-12);
}

TEST(Parameters, AnIrregularMeshHasSixEqualClasses) {
  std::vector<double> lengths;
  for (int i = 0; i < 24; ++i) lengths.push_back(0.01 * std::pow(1.05, i));
  EXPECT_EQ(Classes(Chain(lengths)), 6);
}

}  // namespace
}  // namespace physpring
