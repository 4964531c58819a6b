// SPDX-License-Identifier: Apache-2.0
// Nodes that bounce, slide, are pushed and collide, against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

const Environment kTable{.gravity = {0, 0, -9.81}, .ground = Eigen::Vector4d(0, 0, 1, 0)};

SpringMassSystem Ball(const Vector3d& position, double restitution, double friction) {
  SpringMassSystem system = Particles(position, 0.1);
  system.contact.surface.restitution = restitution;
  system.contact.surface.friction = friction;
  return system;
}

TEST(SimulatorContact, BouncesReachESquaredOfTheHeight) {
  const double e = 0.8, height = 0.3, h = 1e-5;
  SpringMassSystem system = Ball({0, 0, height + 0.01}, e, 0);
  system.contact_radius[0] = 0.01;
  Simulation simulation(system, kTable, h);
  const double speed = std::sqrt(2 * 9.81 * height);
  double expected = height;
  for (int bounce = 1; bounce <= 4; ++bounce) {
    // down, up, and to the top
    while (simulation.velocity()(2, 0) <= 0) simulation.Advance(1);
    while (simulation.velocity()(2, 0) > 0) simulation.Advance(1);
    expected *= e * e;
    // an impact comes up to a sub-step early: h times the speed, each time
    EXPECT_NEAR(simulation.position()(2, 0) - 0.01, expected, bounce * h * speed);
  }
}

// A block that starts at 1 m/s: v^2 / (2 mu g).
double StoppingDistance(double restitution, double friction, double h) {
  Simulation simulation(Ball({0, 0, 0}, restitution, friction), kTable, h, 100);
  simulation.SetVelocity(Vector3d(0.6, 0.8, 0));
  for (int frame = 0; frame < 1000 && simulation.velocity().topRows(2).norm() > 0; ++frame) {
    simulation.Advance(1);
  }
  EXPECT_EQ(simulation.velocity().topRows(2).norm(), 0);
  return simulation.position().topRows(2).norm();
}

TEST(SimulatorContact, FrictionStopsASliderAfterCoulombsDistance) {
  for (double mu : {0.1, 0.3, 1.0}) {
    const double expected = 1 / (2 * mu * 9.81), h = 1e-4;
    EXPECT_NEAR(StoppingDistance(0, mu, h), expected, 1 * h) << mu;  // v h: one sub-step
    // with e > 0 it chatters, but the ground carries the same weight on average
    EXPECT_NEAR(StoppingDistance(0.5, mu, h), expected, 0.01 * expected + 2 * h) << mu;
  }
}

// A block that starts with 1 m/s along x and 0.3 m/s along y: with a pyramidal cone all friction
// acts along x until both velocities are equal, then half of it along each. MuJoCo's own contact
// does the same (its default; soft, so to a few per cent).
TEST(SimulatorContact, PyramidalFrictionAlignsTheVelocities) {
  const double mu = 0.5, h = 1e-4;
  SpringMassSystem block = Ball({0, 0, 0}, 0, mu);
  block.contact.surface.cone = FrictionCone::kPyramidal;
  Simulation simulation(block, kTable, h, 100);  // 10 ms a frame
  simulation.SetVelocity(Vector3d(1, 0.3, 0));
  simulation.Advance(10);
  EXPECT_NEAR(simulation.velocity()(0, 0), 1 - mu * 9.81 * 0.1, 1e-2);
  EXPECT_EQ(simulation.velocity()(1, 0), 0.3);
  simulation.Advance(10);
  const double together = (1 + 0.3 - mu * 9.81 * 0.2) / 2;
  EXPECT_NEAR(simulation.velocity()(0, 0), together, 1e-2);
  EXPECT_NEAR(simulation.velocity()(1, 0), together, 1e-2);
}

// At an angle a below atan(mu) a block stays, above it runs with g (sin a - mu cos a).
TEST(SimulatorContact, ABlockOnASlopeSlidesAboveTheAngleOfFriction) {
  const double mu = 0.5, time = 0.4;
  for (double angle : {std::atan(0.5) - 0.02, std::atan(0.5) + 0.1}) {
    const Vector3d normal(std::sin(angle), 0, std::cos(angle));
    Environment slope = kTable;
    slope.ground = Eigen::Vector4d(normal[0], normal[1], normal[2], 0);
    Simulation simulation(Ball({0, 0, 0}, 0, mu), slope, 1e-4, 4000);
    simulation.Advance(1);
    const double acceleration = std::max(0.0, 9.81 * (std::sin(angle) - mu * std::cos(angle)));
    EXPECT_NEAR(simulation.position().norm(), acceleration * time * time / 2, 1e-3 * time) << angle;
  }
}

TEST(SimulatorContact, NothingSinksIntoTheGround) {
  SpringMassSystem system = RandomSystem(25, 0, 5);
  Simulation simulation(
      system, {.gravity = {0, 0, -9.81}, .ground = Eigen::Vector4d(0, 0, 1, -0.2)}, 1e-3, 1000);
  simulation.Advance(3);
  EXPECT_GT(simulation.position().row(2).minCoeff(), -0.2 + 0.005 - 1e-4 * 3);  // kApproach 3 s
  EXPECT_LT(simulation.position().row(2).minCoeff(), -0.19);
}

// A geom that comes with `speed` along +x and hits a node at rest at the origin, head on.
Simulation Hit(Geom geom, double start, double restitution) {
  geom.position = {start, 0, 0};
  geom.velocity = {2, 0, 0};
  Simulation simulation(Ball({0, 0, 0}, restitution, 0.4), Weightless(), 1e-3, 10);
  simulation.geoms = {geom};
  return simulation;
}

std::vector<Geom> GeomsThatReach30Millimetres() {
  Geom sphere, capsule, box, tilted_box;
  sphere.radius = 0.03;
  capsule.radius = 0.03;
  capsule.half_size = {0, 0, 0.1};
  box.half_size = {0.03, 0.05, 0.05};
  // an edge first
  tilted_box.half_size = {0.03 / std::sqrt(2), 0.03 / std::sqrt(2), 0.05};
  tilted_box.rotation = Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitZ()).toRotationMatrix();
  return {sphere, capsule, box, tilted_box};
}

TEST(SimulatorContact, AGeomKnocksANodeAway) {
  for (const Geom& geom : GeomsThatReach30Millimetres()) {
    Simulation simulation = Hit(geom, -0.1003, 0.25);
    simulation.Advance(3);  // 60 mm: not yet there
    EXPECT_EQ(simulation.velocity().col(0), Vector3d(0, 0, 0));
    simulation.Advance(5);
    EXPECT_NEAR((simulation.velocity().col(0) - Vector3d(2.5, 0, 0)).norm(), 0, 1e-12);
  }
}

// The node rests until the sub-step in which the geom arrives, then moves along with it.
TEST(SimulatorContact, AGeomArrivesInItsSubstep) {
  for (int arrival = 0; arrival < 10; ++arrival) {
    Geom sphere;
    sphere.radius = 0.03;
    const double way = 2e-3;  // in a sub-step
    Simulation simulation = Hit(sphere, -0.03 - (arrival + 0.5) * way, 0);
    simulation.Advance(1);
    EXPECT_NEAR(simulation.position()(0, 0), (10 - arrival) * way, 1e-15) << arrival;
  }
}

TEST(SimulatorContact, AGeomPushesANodeAlong) {
  for (const Geom& geom : GeomsThatReach30Millimetres()) {
    Simulation simulation = Hit(geom, -0.1003, 0);
    simulation.Advance(100);
    EXPECT_NEAR((simulation.velocity().col(0) - Vector3d(2, 0, 0)).norm(), 0, 1e-12);
    const double ahead = simulation.position()(0, 0) - simulation.geoms[0].position[0];
    EXPECT_NEAR(ahead, 0.03, 2e-3);  // a sub-step early
  }
}

TEST(SimulatorContact, TheContactRadiusKeepsTheDistance) {
  Geom sphere;
  sphere.radius = 0.02;
  sphere.position = {-0.1003, 0, 0};
  sphere.velocity = {2, 0, 0};
  SpringMassSystem system = Ball({0, 0, 0}, 0, 0);
  system.contact_radius[0] = 0.01;
  Simulation simulation(system, Weightless(), 1e-3, 10);
  simulation.geoms = {sphere};
  simulation.Advance(100);
  EXPECT_NEAR(simulation.position()(0, 0) - simulation.geoms[0].position[0], 0.03, 2e-3);
}

TEST(SimulatorContact, ASpinningGeomCarriesItsSurfaceAlong) {
  Geom drum;
  drum.radius = 0.1;
  drum.half_size = {0, 0.5, 0};
  drum.angular_velocity = {0, 3, 0};  // its top moves along +x with 0.3 m/s
  Simulation simulation(Ball({0, 0, 0.1}, 0, 1), kTable, 1e-4, 10);
  simulation.geoms = {drum};
  simulation.Advance(40);  // friction needs 0.3 / 9.81 = 31 ms to bring the node to that speed
  const Vector3d arm = simulation.position().col(0);
  const Vector3d surface = Vector3d(0, 3, 0).cross(arm);
  EXPECT_GT(surface[0], 0.29);
  EXPECT_NEAR((simulation.velocity().col(0) - surface).norm(), 0, 0.01 * surface.norm());
}

// Particles without springs, far from each other in the reference configuration.
SpringMassSystem Colliding(int count, double distance, double restitution, double friction) {
  Points position = Points::Zero(3, count);
  for (int i = 0; i < count; ++i) position(0, i) = i;
  SpringMassSystem system = Particles(position, 0.1);
  system.contact.collision_distance = distance;
  system.contact.object.restitution = restitution;
  system.contact.object.friction = friction;
  return system;
}

TEST(SimulatorContact, ParticlesCollideAsTheirMassesSay) {
  SpringMassSystem system = Colliding(2, 0.05, 0.5, 0);
  system.mass << 0.1, 0.3;
  Simulation simulation(system, Weightless(), 1e-3, 10);
  Points velocity = Points::Zero(3, 2);
  velocity(0, 0) = 4;
  simulation.SetVelocity(velocity);
  simulation.Advance(30);
  // centre of mass 1 m/s, relative velocity -4 -> 2: away from it by 1.5 and 0.5
  EXPECT_NEAR(simulation.velocity()(0, 0), 1 - 1.5, 1e-12);
  EXPECT_NEAR(simulation.velocity()(0, 1), 1 + 0.5, 1e-12);
}

TEST(SimulatorContact, SimultaneousImpactsKeepTheMomentum) {
  const int count = 12;
  SpringMassSystem system = Colliding(count, 0.12, 0.7, 0.4);
  Random random(3);
  for (double& mass : system.mass) mass = random(0.05, 0.2);
  const Simulator<double> simulator(system, Weightless(), {.frame_time = 0.02, .substeps = 20});
  Simulator<double>::Workspace workspace(simulator);
  const Points x = random.Box(count, 0.05);
  const Points v = -4 * x;  // all towards the middle
  NodeStates<double> state = simulator.MakeState(x, v);
  simulator.AdvanceFrame({Points(3, 0), Points(3, 0), {}}, &state, &workspace);
  const Points after = simulator.Velocities(state);
  EXPECT_GT((after - v).colwise().norm().minCoeff(), 0.01);  // all were hit
  EXPECT_LT(((after - v) * system.mass).norm(),
            1e-14 * (v.colwise().norm() * system.mass).value());  // 20 sub-steps of rounding
}

TEST(SimulatorContact, ImpactsNeverAddEnergy) {
  const int count = 12;
  double lost = 0;
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    SpringMassSystem system = Colliding(count, 0.12, 1, random(0, 1));
    for (double& mass : system.mass) mass = random(0.05, 0.2);
    const Simulator<double> simulator(system, Weightless(), {.frame_time = 1e-3, .substeps = 1});
    Simulator<double>::Workspace workspace(simulator);
    NodeStates<double> state = simulator.MakeState(random.Box(count, 0.1), random.Box(count, 1));
    const auto energy = [&] {  // twice the kinetic energy
      return (simulator.Velocities(state).colwise().squaredNorm() * system.mass).value();
    };
    for (int frame = 0; frame < 50; ++frame) {
      const double before = energy();
      simulator.AdvanceFrame({Points(3, 0), Points(3, 0), {}}, &state, &workspace);
      ASSERT_LE(energy(), before * (1 + 1e-14)) << seed << " " << frame;  // rounding
      lost += before - energy();
    }
  }
  EXPECT_GT(lost, 1);  // there were impacts
}

}  // namespace
}  // namespace physpring
