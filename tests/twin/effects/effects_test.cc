// SPDX-License-Identifier: Apache-2.0
// What all effects have in common: their adjoints inside the whole simulator, and that values of 0
// change nothing.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "tests/support/forked_rod.h"
#include "tests/support/lanes.h"
#include "tests/support/random_system.h"
#include "tests/support/targeted_rollout.h"
#include "twin/effects/bend_effect.h"
#include "twin/effects/body_coordinate.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"
#include "twin/effects/twist_section.h"
#include "twin/error.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

// Values at which the effect acts strongly within the rollout below, and the step of differences
// relative to a parameter's scale: short for effects whose forces have kinks.
struct Case {
  std::vector<double> values;
  double step;
};

constexpr double kSmooth = 1e-3, kKinked = 1e-5;

const std::map<std::string, Case>& Cases() {
  static const std::map<std::string, Case> kCases = {
      {"air_drag", {{0.3, 1, -2, 0.5}, kSmooth}},
      {"gravity_direction", {{0.3, -0.2}, kSmooth}},
      {"stiffening", {{30}, kSmooth}},
      {"tension_only", {{0.7}, kKinked}},
      {"yield", {{2e-3, 0.1, 1e-3}, kKinked}},
      {"dry_friction", {{0.01, 30}, kKinked}},
      {"viscoelastic", {{0.5, 0.02}, kSmooth}},
      {"bending", {{1e-3}, kSmooth}},
      {"bending_damping", {{1e-5}, kSmooth}},
      {"rest_bend",
       {{1e-2, -2e-2, 1e-2, 0, 2e-2, 1e-2, -1e-2, 1e-2, -1e-2, 1e-2, 0, 2e-2, 1e-2, -1e-2, 0, 1e-2},
        kSmooth}},
      {"bending_friction", {{5e-3, 1}, kKinked}},
      {"twist", {{1e-2, 1}, kSmooth}},
      {"mass_distribution", {{0.1, 0.05, 0.02, -0.03, 0.3, -0.2, 0.1, 0.5}, kSmooth}},
      {"tether", {{5, 0.1, 0.05, 0.02, -0.03, 0.1, 0.2, -0.1}, kSmooth}},
      {"rest_length", {{0.1, -0.05, 0.03, 0.2, -0.1, 1, -2, 0.5}, kSmooth}},
      {"control_latency", {{0.013}, kSmooth}},
      {"ground_contact", {{0.1, 0.1}, kKinked}},
      {"stiffness_drift", {{1.5}, kSmooth}},
      {"custom", {{1, 3, 20, 300, -100, 200, 50, 150, -100}, kSmooth}},
  };
  return kCases;
}

Case CaseOf(const Effect& effect) {
  if (effect.name() != "uniform_force") return Cases().at(effect.name());
  Case test{{0.0213}, kSmooth};
  Random random(5);
  while (static_cast<int>(test.values.size()) < effect.value_count()) {
    test.values.push_back(random(-1, 1));
  }
  return test;
}

EffectValues Values(const Effect& effect, const std::vector<double>& values) {
  return {effect.name(), Eigen::Map<const Eigen::VectorXd>(
                             values.data(), static_cast<Eigen::Index>(values.size()))};
}

// A rollout of four frames of a rod, with controllers that move as recorded.
class Effects : public testing::TestWithParam<const Effect*> {
 protected:
  Effects() : rollout(RandomRollout(4, 1)) {
    rollout.system.rod = PlainRod(Eigen::VectorXd::LinSpaced(27, 0, 0.5));
    recording.fps = 1 / rollout.options.frame_time;
    recording.controllers.push_back(rollout.frames[0].controllers_start);
    for (const FrameInput& frame : rollout.frames) {
      recording.controllers.push_back(frame.controllers_end);
    }
    if (GetParam()->name() == "rest_length") rollout.system.rod = {};  // bends no rod
    if (GetParam()->name() == "ground_contact") {
      rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.085);
      rollout.velocity.row(2).array() -= 1;
      rollout.system.contact.surface.restitution = 0.3;
      rollout.system.contact.surface.friction = 0.02;
    }
  }

  void ReadFrames() {
    for (std::size_t i = 0; i < rollout.frames.size(); ++i) {
      rollout.frames[i] =
          RecordedInput(recording, static_cast<int>(i) + 1, ControllerDelay(rollout.system));
    }
  }

  TargetedRollout rollout;
  Recording recording;
};

TEST_P(Effects, HasTheDerivativesThatDifferencesShow) {
  const Case test = CaseOf(*GetParam());
  rollout.system.effects = {Values(*GetParam(), test.values)};
  ReadFrames();
  const RolloutGradient gradient = Gradient<double>(rollout);
  std::vector<CheckedVariable> variables;
  Eigen::VectorXd& values = rollout.system.effects[0].values;
  Eigen::Index i = 0;
  for (const EffectParameter& parameter : GetParam()->parameters()) {
    const bool logarithmic = parameter.spacing == EffectParameter::Spacing::kLogarithmic;
    for (int n = 0; n < parameter.count; ++n, ++i) {
      const double scale = logarithmic ? values[i] : parameter.scale;
      if (scale == 0) continue;  // says what the effect is, and does not move
      variables.push_back(
          {parameter.key, &values[i], test.step * scale, gradient.system.effects[0][i]});
    }
  }
  const auto loss = [&] {
    ReadFrames();
    return Loss<double>(rollout);
  };
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_GT(gradient.system.effects[0].norm(), 0);
}

TEST_P(Effects, KeepsTheOtherDerivativesRight) {
  const Case test = CaseOf(*GetParam());
  rollout.system.effects = {Values(*GetParam(), test.values)};
  ReadFrames();
  for (const GradientReport& report : CheckRollout(rollout, test.step)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

TEST_P(Effects, ActsSideBySideAsAlone) {
  std::vector<TargetedRollout> rollouts;
  for (int i = 0; i < 6; ++i) {
    std::vector<double> values = CaseOf(*GetParam()).values;
    for (double& value : values) value *= 1 - 0.05 * i;
    rollout.system.effects = {Values(*GetParam(), values)};
    ReadFrames();
    rollouts.push_back(rollout);
  }
  EXPECT_EQ(DifferenceSideBySide(rollouts), "");
}

TEST_P(Effects, ChangesNothingAtZero) {
  const std::vector<Points> without = Simulate<double>(rollout);
  rollout.system.effects = {
      Values(*GetParam(), std::vector<double>(GetParam()->value_count(), 0.0))};
  ReadFrames();
  EXPECT_EQ(Simulate<double>(rollout).back(), without.back());
}

TEST_P(Effects, ChangesTheMotion) {
  const std::vector<Points> without = Simulate<double>(rollout);
  rollout.system.effects = {Values(*GetParam(), CaseOf(*GetParam()).values)};
  ReadFrames();
  EXPECT_GT((Simulate<double>(rollout).back() - without.back()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_P(Effects, StartsWithinItsBounds) {
  for (const Eigen::VectorXd& start : GetParam()->Starts(rollout.system)) {
    EXPECT_NO_THROW(ValidateEffect({GetParam()->name(), start}, "start"));
  }
}

TEST_P(Effects, ComesBackFromJson) {
  const EffectValues effect = Values(*GetParam(), CaseOf(*GetParam()).values);
  const std::vector<EffectValues> read = EffectsFromJson(EffectsToJson({effect, effect}), "here");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].name, effect.name);
  EXPECT_EQ(read[1].values, effect.values);
}

// The case above has controllers that are late.
TEST(ControlLatency, HasTheDerivativeThatDifferencesShowIfNegative) {
  TargetedRollout rollout = RandomRollout(4, 1);
  Recording recording;
  recording.fps = 1 / rollout.options.frame_time;
  recording.controllers.push_back(rollout.frames[0].controllers_start);
  for (const FrameInput& frame : rollout.frames) {
    recording.controllers.push_back(frame.controllers_end);
  }
  rollout.system.effects = {Values(GetEffect("control_latency"), {-0.013})};
  const auto read_frames = [&] {
    for (std::size_t i = 0; i < rollout.frames.size(); ++i) {
      rollout.frames[i] =
          RecordedInput(recording, static_cast<int>(i) + 1, ControllerDelay(rollout.system));
    }
  };
  read_frames();
  Eigen::VectorXd& values = rollout.system.effects[0].values;
  const RolloutGradient gradient = Gradient<double>(rollout);
  const auto loss = [&] {
    read_frames();
    return Loss<double>(rollout);
  };
  const GradientReport report = CheckGradient(
      loss, {{"latency_s", &values[0], kSmooth * 0.02, gradient.system.effects[0][0]}});
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_NE(gradient.system.effects[0][0], 0);
}

std::vector<CheckedVariable> ValuesOfAll(const RolloutGradient& gradient,
                                         TargetedRollout* rollout) {
  std::vector<CheckedVariable> variables;
  for (std::size_t i = 0; i < rollout->system.effects.size(); ++i) {
    EffectValues& effect = rollout->system.effects[i];
    for (Eigen::Index j = 0; j < effect.values.size(); ++j) {
      const double scale = effect.name == "rest_bend" ? 1e-3 : effect.values[j];
      variables.push_back({effect.name + " " + std::to_string(j), &effect.values[j],
                           kKinked * scale, gradient.system.effects[i][j]});
    }
  }
  return variables;
}

// Laws of bending share the geometry of their triples.
TEST(BendingEffects, TogetherHaveTheDerivativesThatDifferencesShow) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.system.rod = PlainRod(Eigen::VectorXd::LinSpaced(27, 0, 0.5));
  for (const char* name : {"bending_friction", "rest_bend", "bending", "bending_damping"}) {
    rollout.system.effects.push_back(Values(GetEffect(name), Cases().at(name).values));
  }
  const RolloutGradient gradient = Gradient<double>(rollout);
  const std::vector<CheckedVariable> variables = ValuesOfAll(gradient, &rollout);
  const auto loss = [&] { return Loss<double>(rollout); };
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
}

// A rod with branches, which is at rest as it is bent in the reference configuration.
TEST(BendingEffects, KeepBranchesAtTheirAngles) {
  SpringMassSystem system;
  system.position = ForkedPlaces();
  system.mass = Eigen::VectorXd::Ones(10);
  system.rod = ForkedRod();
  const auto force_of = [&](const Points& x) {
    const std::unique_ptr<BendMoment> law =
        GetEffect("bending").MakeBend(system, Eigen::VectorXd::Constant(1, 0.1));
    Points force = Points::Zero(3, 10);
    Eigen::VectorXd internal;
    const Points still = Points::Zero(3, 10);
    AddBendForces({{law.get(), 0}}, {0, 1e-3, x, still, {}}, internal, &force);
    return force;
  };
  EXPECT_LT(force_of(system.position).norm(), 1e-6);
  // a branch that is turned towards the straight part is pushed back
  Points turned = system.position;
  const Eigen::AngleAxisd turn(-0.2, Eigen::Vector3d::UnitZ());
  for (int i : {6, 7}) turned.col(i) = turned.col(2) + turn * (turned.col(i) - turned.col(2));
  const Points force = force_of(turned);
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(turned.col(6) - turned.col(2));
  EXPECT_GT(across.normalized().dot(force.col(6)), 0.01);
  EXPECT_LT(force.rowwise().sum().norm(), 1e-12);
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (int i = 0; i < 10; ++i) torque += turned.col(i).cross(force.col(i));
  EXPECT_LT(torque.norm(), 1e-12);
}

// A main rod of nine nodes, the controllers at an end, and branches at every second one.
Rod BranchedRod(const Points& position) {
  RodEdges edges;
  for (int i = 1; i < 9; ++i) edges.push_back({i - 1, i});
  for (int i = 9; i < 25; ++i) edges.push_back({i < 14 ? 2 * (i - 9) : i - 5, i});
  edges.push_back({8, 25});
  edges.push_back({25, 26});
  return RodOfEdges(edges, position);
}

TEST(BendingEffects, AtJointsHaveTheDerivativesThatDifferencesShow) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.system.rod = BranchedRod(rollout.system.position);
  ASSERT_GT(RodJoints(rollout.system.rod), 2);
  for (const char* name : {"bending", "bending_friction", "rest_bend", "bending_damping"}) {
    rollout.system.effects.push_back(Values(GetEffect(name), Cases().at(name).values));
  }
  const RolloutGradient gradient = Gradient<double>(rollout);
  std::vector<CheckedVariable> variables = ValuesOfAll(gradient, &rollout);
  // through the motion: bends at joints depend on where nodes are
  for (int i : {0, 4, 7, 30, 31, 32, 60}) {
    variables.push_back({"velocity " + std::to_string(i), &rollout.velocity.data()[i], 1e-5,
                         gradient.velocity.data()[i]});
  }
  const auto loss = [&] { return Loss<double>(rollout); };
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
}

INSTANTIATE_TEST_SUITE_P(All, Effects, testing::ValuesIn(AllEffects()),
                         [](const auto& test) { return test.param->name(); });

TEST(EffectJson, IsNotNestedDeep) {
  for (const std::string& open : {std::string("["), std::string("[{\"name\":")}) {
    std::string deep;
    for (int i = 0; i < 100000; ++i) deep += open;
    try {
      EffectsFromJson(deep, "a twin");
      ADD_FAILURE() << "was read";
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()), "a twin: is nested more than 32 deep");
    }
  }
}

// A rod of 200 nodes, 5 mm apart.
TEST(PatchWeights, OfNodesFarAwayAreZeroAndNotNearlyZero) {
  constexpr int kNodes = 200;
  SpringMassSystem rod;
  rod.position = Points::Zero(3, kNodes);
  rod.position.row(0).setLinSpaced(kNodes, 0, 0.995);
  rod.mass.setConstant(kNodes, 0.01);
  for (int i = 1; i < kNodes; ++i) rod.springs.push_back({i - 1, i});
  const Eigen::VectorXd weights = PatchWeights(rod, rod.position.col(50));
  EXPECT_GT(weights[50], 0.5);
  EXPECT_NEAR(weights.sum(), 1, 1e-14);
  for (double weight : weights) EXPECT_TRUE(weight == 0 || weight > 1e-90) << weight;
}

TEST(IsAtBound, IsSoNearEitherEndButNotAtNothing) {
  const EffectParameter even{"wind_m_per_s", -30, 30, 1};
  EXPECT_TRUE(IsAtBound(even, 30));
  EXPECT_TRUE(IsAtBound(even, -29.99));
  EXPECT_FALSE(IsAtBound(even, 29));
  const EffectParameter from_nothing{"mass_kg", 0, 3, 1};
  EXPECT_FALSE(IsAtBound(from_nothing, 0));
  EXPECT_TRUE(IsAtBound(from_nothing, 3));
}

TEST(IsAtBound, IsNoShareOfOne) {
  const EffectParameter share = GetEffect("tension_only").parameters().at(0);
  EXPECT_EQ(share.high, 1);
  EXPECT_FALSE(IsAtBound(share, 1)) << "no spring holds at all: nothing is beyond";
}

TEST(Twist, BetweenJointsHasTheDerivativesThatDifferencesShow) {
  TargetedRollout rollout = RandomRollout(4, 1);
  rollout.system.rod = BranchedRod(rollout.system.position);
  ASSERT_TRUE(HasTwistSections(rollout.system.rod, rollout.system.node_count()));
  rollout.system.effects = {Values(GetEffect("twist"), Cases().at("twist").values)};
  const RolloutGradient gradient = Gradient<double>(rollout);
  const auto loss = [&] { return Loss<double>(rollout); };
  const GradientReport report = CheckGradient(loss, ValuesOfAll(gradient, &rollout));
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_GT(gradient.system.effects[0].cwiseAbs().minCoeff(), 0);
  for (const GradientReport& other : CheckRollout(rollout, kSmooth)) {
    EXPECT_TRUE(other.passed) << other.log;
  }
}

}  // namespace
}  // namespace physpring
