// SPDX-License-Identifier: Apache-2.0
// Where nodes touch each other, and the adjoint, one sub-step at a time.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "tests/support/contact_scene.h"
#include "twin/contact.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

// A dozen particles that fly into each other.
Scene Crowd() {
  Random random(5);
  const Points x = random.Box(12, 0.05);
  Scene scene(x, -4 * x + random.Box(12, 0.1));
  scene.system.contact = {{0, 0}, {0.6, 0.2}, 0.06};
  for (double& mass : scene.system.mass) mass = random(0.05, 0.2);
  scene.pairs = Contact<double>(scene.system, scene.environment)
                    .FindPairs(StateAt(scene.x, Points::Zero(3, 12)), 0.01);
  return scene;
}

TEST(ContactAdjoint, MatchesDifferencesInACrowd) {
  const Scene scene = Crowd();
  EXPECT_GT(((scene.After() - scene.v).colwise().norm().array() > 0).count(), 6);
  ExpectGradientsMatch(scene);
}

TEST(ContactAdjoint, MatchesDifferencesInACrowdOnTheGround) {
  Scene scene = Crowd();
  scene.environment.ground = Eigen::Vector4d(0, 0, 1, -0.01);
  scene.system.contact.surface.restitution = 0.5;
  scene.system.contact.surface.friction = 0.1;
  ExpectGradientsMatch(scene);
}

TEST(Contact, OfACrowdKeepsTheMomentum) {
  const Scene scene = Crowd();
  const Vector3d change = (scene.After() - scene.v) * scene.system.mass;
  EXPECT_LT(change.norm(), 1e-15 * (scene.v.colwise().norm() * scene.system.mass).value());
}

Scene TwoParticles(double distance, double speed) {
  Points x = Points::Zero(3, 2), v = Points::Zero(3, 2);
  x(0, 1) = distance;
  v(0, 1) = -speed;
  Scene scene(x, v);
  scene.system.contact = {{0, 0}, {1, 0}, 0.05};
  scene.pairs = {{0, 1}};
  return scene;
}

TEST(Contact, ParticlesCollideWithinTheCollisionDistance) {
  EXPECT_EQ(TwoParticles(0.0501, 1).After(), TwoParticles(0.0501, 1).v);
  Points swapped = Points::Zero(3, 2);
  swapped(0, 0) = -1;
  EXPECT_EQ(TwoParticles(0.0499, 1).After(), swapped);
  EXPECT_EQ(TwoParticles(0.0499, 0.5 * kApproach).After(), TwoParticles(0.0499, 0.5 * kApproach).v);
  EXPECT_EQ(TwoParticles(0.0499, -1).After(), TwoParticles(0.0499, -1).v);
}

Contact<double>::Pairs PairsOf(const SpringMassSystem& system, const Points& x, double speed = 0) {
  NodeStates<double> state = StateAt(x, Points::Zero(3, x.cols()));
  state[0].v[1] = speed;
  return Contact<double>(system, Weightless()).FindPairs(state, 0.01);
}

TEST(Contact, NeitherJoinedNodesNorNeighboursCollide) {
  // 0 and 1 are joined, 1 and 2 are near in the reference, 2 and 3 meet now
  Points reference = Points::Zero(3, 4);
  reference.row(0) << 0, 1, 1.04, 2;
  SpringMassSystem system = Particles(reference, 1);
  system.contact.collision_distance = 0.05;
  AddSpring(1, 0, 1, 1, 0, &system);
  Points x = Points::Zero(3, 4);
  x.row(0) << 0, 0.03, 0.06, 0.09;
  EXPECT_EQ(PairsOf(system, x), (Contact<double>::Pairs{{2, 3}}));
}

TEST(Contact, PairsThatMayMeetWithinTheFrameAreFound) {
  const SpringMassSystem system = Crowd().system;  // 0.06 m
  Points x = Points::Zero(3, 12);
  for (int i = 0; i < 12; ++i) x(0, i) = i;
  x(0, 1) = 0.09;
  EXPECT_TRUE(PairsOf(system, x, 1.0).empty());                          // 2 x 1 cm
  EXPECT_EQ(PairsOf(system, x, 2.0), (Contact<double>::Pairs{{0, 1}}));  // 2 x 2 cm
  x(0, 1) = 0.125;
  EXPECT_TRUE(PairsOf(system, x, 100).empty());  // more than one distance is not foreseen
}

TEST(Contact, WithoutACollisionDistanceThereAreNoPairs) {
  EXPECT_TRUE(PairsOf(Particles(Points::Zero(3, 4), 1), Points::Zero(3, 4)).empty());
}

TEST(Contact, UndoGivesTheVelocitiesBefore) {
  Scene scene = Crowd();
  scene.environment.ground = Eigen::Vector4d(0, 0, 1, -0.01);
  const Contact<double> contact(scene.system, scene.environment);
  const NodeStates<double> state = StateAt(scene.x, scene.v);
  NodeStates<double> next = state;
  Contact<double>::Impacts impacts;
  for (int repeat = 0; repeat < 2; ++repeat) {
    contact.Apply(state, scene.pairs, {}, 0, kStep, &next, &impacts);
    EXPECT_NE(0, std::memcmp(next.data(), state.data(), next.size() * sizeof(next[0])));
    contact.Undo(impacts, &next);
    EXPECT_EQ(0, std::memcmp(next.data(), state.data(), next.size() * sizeof(next[0])));
  }
}

TEST(ContactAdjoint, AddsToWhatIsThere) {
  const Scene scene = Crowd();
  NodeStates<double> state_bar(12);
  ContactGradient<double> gradient{std::vector<double>(12, 0), {}};
  const auto add = [&] {
    for (NodeState<double>& bar : state_bar) std::copy_n(std::array{1., 2., 3.}.data(), 3, bar.v);
    state_bar[3].v[0] = -3;
    scene.AddGradient(&state_bar, &gradient);
  };
  add();
  const NodeStates<double> once = state_bar;
  const ContactGradient<double> gradient_once = gradient;
  const ContactPair<double> law_once = gradient.laws.object;
  EXPECT_NE(law_once.restitution, 0);
  EXPECT_NE(gradient_once.mass[3], 0);
  add();
  const auto twice = [](double once_value) { return 1e-12 * (1 + std::abs(once_value)); };
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(state_bar[i].x[j], 2 * once[i].x[j], twice(once[i].x[j]));
    }
    EXPECT_NEAR(gradient.mass[i], 2 * gradient_once.mass[i], twice(gradient_once.mass[i]));
  }
  EXPECT_NEAR(gradient.laws.object.restitution, 2 * law_once.restitution, 1e-12);
  EXPECT_NEAR(gradient.laws.object.friction, 2 * law_once.friction, 1e-12);
}

}  // namespace
}  // namespace physpring
