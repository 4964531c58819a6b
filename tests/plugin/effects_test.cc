// SPDX-License-Identifier: Apache-2.0
// Effects in physpring.springs: each moves the nodes as in the trainer's simulator.
#include <gtest/gtest.h>

#include "tests/support/level_scene.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr double kSubstep = 0.25e-3;  // s
constexpr int kSubsteps = 8, kSteps = 50;

// As an attribute of MJCF.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (char c : text) escaped += c == '"' ? "&quot;" : std::string(1, c);
  return escaped;
}

SpringMassSystem Rod() {
  SpringMassSystem rod = RandomSystem(40, 2, 3);
  rod.rod = PlainRod(Eigen::VectorXd::LinSpaced(42, 0, 1));
  return rod;
}

LevelSceneOptions WithEffects(const SpringMassSystem& system) {
  std::string order;
  for (double s : system.rod.arc) order += std::to_string(s) + " ";
  std::string edges;
  for (const auto& [a, b] : system.rod.edges) {
    edges += std::to_string(a) + " " + std::to_string(b) + " ";
  }
  return {
      .timestep = kSubsteps * kSubstep,
      .substep = kSubstep,
      .config = {
          {"order", order}, {"rod", edges}, {"effects", Escaped(EffectsToJson(system.effects))}}};
}

double DistanceFromSimulator(const SpringMassSystem& system) {
  Simulation simulation(system, {}, kSubstep, kSubsteps);
  LevelScene scene(system, WithEffects(system));
  scene.SetState(simulation.position(), simulation.velocity());
  simulation.Advance(kSteps);
  scene.Step(kSteps);
  return (simulation.position() - scene.Positions()).colwise().norm().maxCoeff();
}

TEST(Effects, BendARodWithBranchesAsInTheSimulator) {
  SpringMassSystem system = Rod();
  RodEdges edges;
  for (int i = 1; i < 42; ++i) edges.push_back({i == 30 ? 10 : i - 1, i});
  system.rod = RodOfEdges(edges, system.position);
  for (double& s : system.rod.arc) s = std::stod(std::to_string(s));
  system.effects = {{"bending", GetEffect("bending").Starts(system)[1]}};
  EXPECT_LT(DistanceFromSimulator(system), 1e-9);
}

TEST(Effects, MoveNodesAsInTheSimulator) {
  int tested = 0;
  for (const Effect* effect : AllEffects()) {
    SpringMassSystem system = Rod();
    for (double& s : system.rod.arc) s = std::stod(std::to_string(s));
    const Eigen::VectorXd values = effect->Starts(system)[0];
    if (!effect->HasForces(system, values)) continue;
    system.effects = {{effect->name(), values}};
    EXPECT_LT(DistanceFromSimulator(system), 1e-9) << effect->name();
    ++tested;
  }
  EXPECT_GT(tested, 5);
}

TEST(Effects, WithoutForcesAreRefused) {
  SpringMassSystem system = Rod();
  const std::string name = "gravity_direction";
  const Effect& effect = GetEffect(name);
  system.effects = {{effect.name(), effect.Starts(system)[0]}};
  EXPECT_THROW(LevelScene(system, WithEffects(system)), Error);
}

}  // namespace
}  // namespace physpring
