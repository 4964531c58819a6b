// SPDX-License-Identifier: Apache-2.0
// Where contacts act, with which normal, and their adjoint, one sub-step at a time.
#include "twin/contact.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 1e-3;     // h, s
constexpr double kElapsed = 0.02;  // since the start of the frame, s

NodeStates<double> StateAt(const Points& x, const Points& v) {
  NodeStates<double> state(x.cols());
  for (int i = 0; i < x.cols(); ++i) {
    for (int j = 0; j < 3; ++j) {
      state[i].x[j] = x(j, i);
      state[i].v[j] = v(j, i);
    }
  }
  return state;
}

// Nodes in contact, with all that the velocities after a sub-step depend on.
struct Scene {
  SpringMassSystem system;
  Environment environment = Weightless();
  std::vector<Geom> geoms;
  Points x, v;
  Contact<double>::Pairs pairs;

  // Nodes at x, far apart from each other in the reference configuration.
  explicit Scene(const Points& position, const Points& velocity) : x(position), v(velocity) {
    Points apart = Points::Zero(3, x.cols());
    for (int i = 0; i < x.cols(); ++i) apart(0, i) = i;
    system = Particles(apart, 0.1);
  }

  Points After() const {
    NodeStates<double> next = StateAt(x, v);
    Contact<double>::Impacts impacts;
    Contact<double>(system, environment)
        .Apply(StateAt(x, v), pairs, geoms, kElapsed, kStep, &next, &impacts);
    Points after(3, v.cols());
    for (int i = 0; i < v.cols(); ++i) after.col(i) << next[i].v[0], next[i].v[1], next[i].v[2];
    return after;
  }
  // state_bar: the v in with respect to the velocities after, out before; adds to the x.
  void AddGradient(NodeStates<double>* state_bar, ContactGradient<double>* gradient) const {
    const Contact<double> contact(system, environment);
    const NodeStates<double> state = StateAt(x, v);
    NodeStates<double> next = state;
    Contact<double>::Impacts impacts;
    contact.Apply(state, pairs, geoms, kElapsed, kStep, &next, &impacts);
    contact.ApplyAdjoint(state, &impacts, state_bar, gradient);
  }
};

// Compares the gradient of sum of bar . v' with differences, for everything that v' depends on.
std::vector<GradientReport> CheckGradients(Scene scene) {
  const int nodes = static_cast<int>(scene.x.cols());
  const Points bar = Random(9).Box(nodes, 1);
  const auto loss = [&] {
    const Points after = scene.After();
    long double sum = 0;
    for (double term : bar.cwiseProduct(after).reshaped()) sum += term;
    return sum;
  };
  NodeStates<double> state_bar = StateAt(Points::Zero(3, nodes), bar);
  ContactGradient<double> gradient{std::vector<double>(nodes, 0), {}};
  scene.AddGradient(&state_bar, &gradient);

  std::vector<CheckedVariable> x, v, mass;
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::string name = fmt::format("{}.{}", i, j);
      x.push_back({"x" + name, &scene.x(j, i), 1e-6, state_bar[i].x[j]});
      v.push_back({"v" + name, &scene.v(j, i), 1e-5, state_bar[i].v[j]});
    }
    mass.push_back({fmt::format("m{}", i), &scene.system.mass[i], 1e-5, gradient.mass[i]});
  }
  ContactCoefficients& c = scene.system.contact;
  const std::vector<CheckedVariable> laws = {
      {"restitution", &c.restitution, 1e-4, gradient.laws.surface.restitution},
      {"friction", &c.friction, 1e-4, gradient.laws.surface.friction},
      {"object restitution", &c.object_restitution, 1e-4, gradient.laws.object.restitution},
      {"object friction", &c.object_friction, 1e-4, gradient.laws.object.friction}};
  std::vector<GradientReport> reports;
  for (const auto& variables : {x, v, mass, laws}) {
    reports.push_back(CheckGradient(loss, variables));
  }
  return reports;
}

void ExpectGradientsMatch(const Scene& scene) {
  for (const GradientReport& report : CheckGradients(scene)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

// A place around a geom, in the geom's axes, with the outward normal there.
struct Place {
  std::string name;
  Vector3d half_size;
  double radius;
  Vector3d at;      // 0.1 mm off the surface where not inside
  Vector3d normal;  // not yet of length 1
};

const std::vector<Place> kPlaces = {
    {"sphere", {0, 0, 0}, 0.05, 0.0501 * Vector3d(2, -3, 6) / 7, {2, -3, 6}},
    {"sphere, inside", {0, 0, 0}, 0.05, 0.03 * Vector3d(2, -3, 6) / 7, {2, -3, 6}},
    {"capsule, side", {0, 0, 0.1}, 0.05, {0.03006, 0.04008, 0.03}, {3, 4, 0}},
    {"capsule, cap",
     {0, 0, 0.1},
     0.05,
     {0.0501 * 2 / 7, 0.0501 * -3 / 7, -0.1 - 0.0501 * 6 / 7},
     {2, -3, -6}},
    {"box, face", {0.03, 0.04, 0.05}, 0, {0.01, -0.0401, 0.02}, {0, -1, 0}},
    {"box, edge", {0.03, 0.04, 0.05}, 0, {0.03006, -0.01, -0.05008}, {3, 0, -4}},
    {"box, corner",
     {0.03, 0.04, 0.05},
     0,
     {-0.03 - 2e-4 / 7, 0.04 + 3e-4 / 7, 0.05 + 6e-4 / 7},
     {-2, 3, 6}},
    {"box, inside", {0.03, 0.04, 0.05}, 0, {0.01, 0.039, 0.02}, {0, 1, 0}},
    {"rounded box, edge",
     {0.03, 0.04, 0.05},
     0.01,
     {0.03 + 0.0101 * 0.6, 0.02, 0.05 + 0.0101 * 0.8},
     {3, 0, 4}},
};

// A node that comes with `approach` (in the geom's axes, relative to the surface) to a place of a
// geom that is turned, moves and spins.
Scene At(const Place& place, const Vector3d& approach) {
  Geom geom;
  geom.half_size = place.half_size;
  geom.radius = place.radius;
  geom.position = {0.3, -0.2, 0.1};
  geom.rotation = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -2) / 3).toRotationMatrix();
  geom.velocity = {0.5, 0.1, -0.2};
  geom.angular_velocity = {2, -3, 1};
  std::vector<Geom> moved{geom};
  MoveOn(kElapsed, &moved);
  const Vector3d arm = moved[0].rotation * place.at;
  const Vector3d surface_velocity = geom.velocity + geom.angular_velocity.cross(arm);
  Scene scene(moved[0].position + arm, surface_velocity + moved[0].rotation * approach);
  scene.geoms = {geom};
  return scene;
}

Vector3d SomeTangent(const Vector3d& normal) {
  return normal.cross(Vector3d(0.3, 1, 0.2)).normalized();
}

TEST(Contact, ReflectsAtTheNormalOfTheGeom) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized(), t = SomeTangent(n);
    Scene scene = At(place, -2 * n + 0.5 * t);
    scene.system.contact.restitution = 0.25;
    const Scene expected = At(place, 0.5 * n + 0.5 * t);
    EXPECT_NEAR((scene.After() - expected.v).norm(), 0, 1e-12) << place.name;
  }
}

TEST(Contact, StopsTheSlidingRelativeToTheSurface) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized(), t = SomeTangent(n);
    Scene scene = At(place, -2 * n + 0.5 * t);
    scene.system.contact.friction = 1;
    EXPECT_NEAR((scene.After() - At(place, {0, 0, 0}).v).norm(), 0, 1e-12) << place.name;
  }
}

TEST(Contact, LeavesANodeThatDoesNotApproach) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized();
    for (double speed : {1.0, 0.0, -0.5 * kApproach}) {
      const Scene scene = At(place, speed * n + 0.5 * SomeTangent(n));
      EXPECT_EQ(scene.After(), scene.v) << place.name;
    }
  }
}

TEST(ContactAdjoint, MatchesDifferencesAtAGeom) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized(), t = SomeTangent(n);
    for (double friction : {0.05, 0.9}) {  // slides, sticks
      Scene scene = At(place, -0.7 * n + 0.5 * t);
      scene.system.contact = {0.4, friction, 0, 0, 0};
      for (const GradientReport& report : CheckGradients(scene)) {
        EXPECT_TRUE(report.passed) << place.name << "\n" << report.log;
      }
    }
  }
}

TEST(Contact, BeginsWhereTheSurfaceIsReachedWithinTheSubstep) {
  Scene scene(Vector3d(0, 0, 0), Vector3d(0, 0, -2));
  scene.environment.ground = Eigen::Vector4d(0, 0, 1, 0.05);
  scene.system.contact_radius[0] = 0.01;
  const double gap = 2 * kStep;
  scene.x(2, 0) = 0.05 + 0.01 + 1.001 * gap;
  EXPECT_EQ(scene.After(), scene.v);
  scene.x(2, 0) = 0.05 + 0.01 + 0.999 * gap;
  EXPECT_EQ(scene.After(), Points(Vector3d(0, 0, 0)));
}

TEST(ContactAdjoint, MatchesDifferencesOnASlope) {
  for (double friction : {0.1, 1.5}) {
    Scene scene(Vector3d(0.1, 0.2, -0.3), Vector3d(0.5, 0.3, -1));
    scene.environment.ground = Eigen::Vector4d(2, 3, 6, 0.7) / 7;
    scene.system.contact = {0.6, friction, 0, 0, 0};
    ASSERT_NE(scene.After(), scene.v);
    ExpectGradientsMatch(scene);
  }
}

TEST(ContactAdjoint, MatchesDifferencesBetweenTwoSurfaces) {
  const Place& face = kPlaces[4];
  Scene scene = At(face, {0.3, 1, -0.4});
  scene.system.contact = {0.4, 0.1, 0, 0, 0};
  const Points alone = scene.After();
  const Vector3d x = scene.x.col(0), n = -Vector3d(scene.v.col(0)).normalized();
  scene.environment.ground = Eigen::Vector4d(n[0], n[1], n[2], n.dot(x) - 1e-4);
  ASSERT_NE(scene.After(), alone);
  ExpectGradientsMatch(scene);
}

// A dozen particles that fly into each other.
Scene Crowd() {
  Random random(5);
  const Points x = random.Box(12, 0.05);
  Scene scene(x, -4 * x + random.Box(12, 0.1));
  scene.system.contact = {0, 0, 0.6, 0.2, 0.06};
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
  scene.system.contact.restitution = 0.5;
  scene.system.contact.friction = 0.1;
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
  scene.system.contact = {0, 0, 1, 0, 0.05};
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
