// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/support/random_system.h"
#include "trainer/bodies/spring_net.h"

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

// A smooth body's numbers come before those of effects, with the body's own prior.
TEST(EffectModel, MovesASmoothBody) {
  SpringMassSystem base = RandomSystem(25, 2, 1);
  base.dashpot = 1e-3 * base.stiffness;
  Recording recording;
  recording.fps = 50;
  const auto body =
      std::make_shared<const SmoothBody>(base, recording, SpringNet(), SmoothBody::Options{1e6});
  const EffectModel model(body, {{"tension_only", Eigen::VectorXd::Constant(1, 0.4)}});
  ASSERT_EQ(model.size(), body->size() + 1);
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(model.size(), -0.2, 0.2);
  const SpringMassSystem system = model.Apply(x), alone = body->Apply(x.head(body->size()));
  EXPECT_EQ(system.stiffness, alone.stiffness);
  EXPECT_EQ(system.dashpot, alone.dashpot);
  ASSERT_EQ(system.effects.size(), 1U);
  EXPECT_GT(system.effects[0].values[0], 0.4);
  const Eigen::MatrixXd precision = model.Precision(x);
  const int own = body->size();
  EXPECT_EQ(precision.topLeftCorner(own, own), body->Precision(x.head(own)));
  EXPECT_EQ(precision(own, own), kDiagnosisPrecision);
}

}  // namespace
}  // namespace physpring
