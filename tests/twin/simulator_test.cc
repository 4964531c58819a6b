// SPDX-License-Identifier: Apache-2.0
// The motion of springs and masses against closed forms and conservation laws.
#include "twin/simulator.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/random_system.h"
#include "tests/support/simulation.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

// Two masses and a spring, stretched by `stretch` and let go: the stretch s obeys
//   s_{n+1} - s_n = (1 - h gamma) (s_n - s_{n-1}) - (h omega)^2 s_n,
// with the solution s_n = r^n (s_0 cos(n theta) + B sin(n theta)),
//   r^2 = 1 - h gamma,   2 r cos(theta) = 2 - h gamma - (h omega)^2.
struct Oscillator {
  double h = 0.01;        // s
  double omega = 50;      // rad/s
  double gamma = 0;       // 1/s
  double stretch = 0.01;  // m

  SpringMassSystem System() const {
    Points position(3, 2);
    position.col(0) = Vector3d(0.1, 0.2, 0.3);
    position.col(1) = position.col(0) + (0.1 + stretch) * Axis();
    SpringMassSystem system = Particles(position, 1);
    system.mass = Eigen::Vector2d(0.2, 0.3);
    const double reduced = 0.2 * 0.3 / 0.5;
    AddSpring(0, 1, reduced * omega * omega, 0.1, reduced * gamma, &system);
    return system;
  }
  static Vector3d Axis() { return Vector3d(2, -3, 6) / 7; }

  double Stretch(int step) const {
    const double r = std::sqrt(1 - h * gamma);
    const double theta = std::acos((2 - h * gamma - h * h * omega * omega) / (2 * r));
    const double first = stretch * (1 - h * h * omega * omega);
    const double b = (first / r - stretch * std::cos(theta)) / std::sin(theta);
    return std::pow(r, step) * (stretch * std::cos(step * theta) + b * std::sin(step * theta));
  }
};

double StretchOf(const Simulation& simulation) {
  const Points x = simulation.position();
  return (x.col(1) - x.col(0)).norm() - 0.1;
}

// cos(omega' h) = 1 - (omega h)^2 / 2: the frequency omega' that the steps show
TEST(Simulator, TwoMassesSwingAtTheFrequencyOfTheSteps) {
  const Oscillator oscillator;
  Simulation simulation(oscillator.System(), Weightless(), oscillator.h);
  for (int step = 1; step <= 1000; ++step) {
    simulation.Advance(1);
    ASSERT_NEAR(StretchOf(simulation), oscillator.Stretch(step), 1e-13) << step;  // rounding
  }
}

TEST(Simulator, DampedMassesDecayAtTheRateOfTheSteps) {
  const Oscillator oscillator{.gamma = 5};
  Simulation simulation(oscillator.System(), Weightless(), oscillator.h);
  for (int step = 1; step <= 1000; ++step) {
    simulation.Advance(1);
    ASSERT_NEAR(StretchOf(simulation), oscillator.Stretch(step), 1e-13) << step;  // rounding
  }
}

// s(t) = s_0 exp(-gamma t / 2) (cos(w t) + gamma / (2 w) sin(w t)),  w^2 = omega^2 - gamma^2 / 4
TEST(Simulator, ConvergesToTheContinuousOscillatorInFirstOrder) {
  const double gamma = 8, omega = 50, time = 0.1;
  const double w = std::sqrt(omega * omega - gamma * gamma / 4);
  const double exact = 0.01 * std::exp(-gamma * time / 2) *
                       (std::cos(w * time) + gamma / (2 * w) * std::sin(w * time));
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const int steps = 2000 << i;
    const Oscillator oscillator{.h = time / steps, .omega = omega, .gamma = gamma};
    Simulation simulation(oscillator.System(), Weightless(), oscillator.h, steps);
    simulation.Advance(1);
    error[i] = std::abs(StretchOf(simulation) - exact);
  }
  EXPECT_LT(error[0], 0.01 * omega * time / 2000);  // s_0 omega h
  EXPECT_NEAR(error[0] / error[1], 2, 0.02);
}

// Spring i of a chain of n masses carries the n - i masses below it.
TEST(Simulator, AHangingChainStretchesByTheWeightBelow) {
  const int n = 5;
  const double mass = 0.02, stiffness = 100, length = 0.05;
  Points position = Points::Zero(3, n + 1);
  for (int i = 0; i < n; ++i) position(2, i) = -length * (i + 1);
  SpringMassSystem system = Particles(position, mass, 1);  // the last column, 0, holds the chain
  AddSpring(n, 0, stiffness, length, 0.5, &system);
  for (int i = 1; i < n; ++i) AddSpring(i - 1, i, stiffness, length, 0.5, &system);
  system.drag = 10;
  Simulation simulation(system, {}, 1e-3, 10000);
  simulation.Advance(1);
  double z = 0;
  for (int i = 0; i < n; ++i) {
    z -= length + (n - i) * mass * 9.81 / stiffness;
    EXPECT_NEAR(simulation.position()(2, i), z, 1e-9) << i;  // what is left of the motion
  }
}

// A random network with large motion, away from everything.
struct Network {
  SpringMassSystem system = RandomSystem(25, 0, 3);
  Points velocity = Random(4).Box(25, 0.5);

  Simulation Start(double h, int substeps) const {
    Simulation simulation(system, Weightless(), h, substeps);
    simulation.SetVelocity(velocity);
    return simulation;
  }
  Vector3d Momentum(const Simulation& simulation) const {
    return simulation.velocity() * system.mass;
  }
  Vector3d AngularMomentum(const Simulation& simulation) const {
    const Points x = simulation.position(), v = simulation.velocity();
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < 25; ++i)
      sum += system.mass[i] * Vector3d(x.col(i)).cross(Vector3d(v.col(i)));
    return sum;
  }
  double Energy(const Simulation& simulation) const {
    const Points x = simulation.position();
    double energy = 0.5 * simulation.velocity().colwise().squaredNorm() * system.mass;
    for (int e = 0; e < system.spring_count(); ++e) {
      const auto [a, b] = system.springs[e];
      const double stretch = (x.col(b) - x.col(a)).norm() - system.rest_length[e];
      energy += 0.5 * system.stiffness[e] * stretch * stretch;
    }
    return energy;
  }
};

TEST(Simulator, AFreeNetworkKeepsItsMomentum) {
  Network network;
  network.system.drag = 0;
  Simulation simulation = network.Start(1e-3, 10);
  const Vector3d before = network.Momentum(simulation);
  const double size = network.velocity.colwise().norm() * network.system.mass;
  for (int frame = 0; frame < 200; ++frame) {
    simulation.Advance(1);
    ASSERT_LT((network.Momentum(simulation) - before).norm(), 1e-12 * size);
  }
}

// x' = x + h v' and central forces: the steps keep it exactly, not only in the limit.
TEST(Simulator, AFreeNetworkKeepsItsAngularMomentum) {
  Network network;
  network.system.drag = 0;
  Simulation simulation = network.Start(1e-3, 10);
  const Vector3d before = network.AngularMomentum(simulation);
  for (int frame = 0; frame < 200; ++frame) {
    simulation.Advance(1);
    ASSERT_LT((network.AngularMomentum(simulation) - before).norm(), 1e-12 * before.norm());
  }
}

TEST(Simulator, DampingNeverRaisesTheEnergy) {
  Network network;
  network.system.drag = 0;
  Simulation simulation = network.Start(2e-5, 250);
  double energy = network.Energy(simulation);
  const double start = energy;
  for (int frame = 0; frame < 100; ++frame) {
    simulation.Advance(1);
    const double next = network.Energy(simulation);
    ASSERT_LT(next, energy) << frame;
    energy = next;
  }
  EXPECT_LT(energy, 0.5 * start);
}

// A symplectic step: the energy swings (by about h omega / 2) but goes nowhere. An explicit one
// would have exploded long before.
TEST(Simulator, WithoutDampingTheEnergyDoesNotDrift) {
  Network network;
  network.system.drag = 0;
  network.system.dashpot.setZero();
  Simulation simulation = network.Start(5e-4, 20);
  const double start = network.Energy(simulation);
  double early = 0, late = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    simulation.Advance(1);
    const double energy = network.Energy(simulation);
    ASSERT_NEAR(energy, start, 0.1 * start) << frame;
    if (frame < 250) early += energy / 250;
    if (frame >= 750) late += energy / 250;
  }
  EXPECT_NEAR(late, early, 0.005 * start);
}

TEST(Simulator, DragIsExponential) {
  SpringMassSystem system = Particles(Points::Zero(3, 1), 0.7);
  system.drag = 3;
  Simulation simulation(system, Weightless(), 1e-3, 500);
  simulation.SetVelocity(Vector3d(1, -2, 3));
  simulation.Advance(1);
  const Vector3d expected = Vector3d(1, -2, 3) * std::exp(-1.5);
  EXPECT_LT((simulation.velocity().col(0) - expected).norm(), 1e-12);  // 500 roundings
}

// x_n = h^2 g n (n + 1) / 2, whatever the mass
TEST(Simulator, MassesFallAlike) {
  SpringMassSystem system = Particles(Points::Zero(3, 2), 0.1);
  system.mass[1] = 5;
  const double h = 1e-3;
  const int n = 1000;
  Simulation simulation(system, {.gravity = {1, 2, -9}, .ground = {}}, h, n);
  simulation.Advance(1);
  const Vector3d expected = Vector3d(1, 2, -9) * (h * h * n * (n + 1) / 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT((simulation.position().col(i) - expected).norm(), 1e-12);  // 1000 roundings
  }
}

// How far a mass on a spring is behind its place when its controller has moved at 0.2 m/s for 20 s,
// the mass itself from the start. Within a sub-step the controller is placed before the mass moves:
// at its end the mass is h v ahead of where the spring saw it.
double LagBehindTheController(bool controller_velocity) {
  Points position = Points::Zero(3, 2);
  position(0, 1) = 0.1;
  SpringMassSystem system = Particles(position, 0.05, 1);
  AddSpring(0, 1, 40, 0.1, 0.3, &system);
  Simulation simulation(system, Weightless(), 1e-3, 10, controller_velocity);
  const Vector3d velocity(0.2, 0, 0);
  simulation.SetVelocity(velocity);
  simulation.Advance(2000, velocity);
  return 0.2 * 20 + 1e-3 * 0.2 - simulation.position()(0, 0);
}

TEST(Simulator, ADashpotFeelsHowFastTheControllerMoves) {
  EXPECT_NEAR(LagBehindTheController(true), 0, 1e-11);  // 2000 roundings of 4 m
}

// PhysTwin's controllers have no velocity: the dashpot holds the mass back, c v = k lag.
TEST(Simulator, ADashpotTakesTheControllerForStillIfTold) {
  EXPECT_NEAR(LagBehindTheController(false), 0.3 * 0.2 / 40, 1e-11);
}

TEST(Simulator, ControllersEndTheFrameWhereTheInputSays) {
  SpringMassSystem system = Particles(Random(5).Box(3, 1), 1, 2);
  AddSpring(0, 1, 1, 1, 0, &system);
  for (int substeps : {1, 2, 3}) {
    Simulation simulation(system, Weightless(), 0.01, substeps);
    const Points velocity = Random(6).Box(2, 1);
    simulation.Advance(2, velocity);
    const Points end = system.position.rightCols(2) + 2 * 0.01 * substeps * velocity;
    for (int c = 0; c < 2; ++c) {
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(simulation.state()[1 + c].x[j], end(j, c), 1e-15) << substeps;
        EXPECT_NEAR(simulation.state()[1 + c].v[j], velocity(j, c), 1e-13) << substeps;
      }
    }
  }
}

TEST(Simulator, MakeStateAndPositionsAreInverse) {
  const SpringMassSystem system = RandomSystem(10, 2, 7);
  const Simulator<double> simulator(system, {}, {});
  const Points x = Random(8).Box(10, 1), v = Random(9).Box(10, 1);
  const NodeStates<double> state = simulator.MakeState(x, v);
  EXPECT_EQ(simulator.Positions(state), x);
  EXPECT_EQ(simulator.Velocities(state), v);
}

TEST(Simulator, SetParametersIsANewSimulator) {
  const SpringMassSystem first = RandomSystem(10, 1, 7);
  SpringMassSystem second = first;
  second.stiffness *= 2;
  second.rest_length *= 1.1;
  second.dashpot *= 3;
  second.mass *= 0.7;
  second.drag = 2;
  second.contact.surface.restitution = 0.9;
  second.contact.surface.friction = 0.1;
  const Environment environment{.gravity = {0, 0, -9.81}, .ground = Eigen::Vector4d(0, 0, 1, -0.1)};
  const SimulationOptions options{.frame_time = 0.2, .substeps = 400};
  const Points hand = first.position.rightCols(1);
  const Points x = first.position.leftCols(10);
  const auto end = [&](const Simulator<double>& simulator) {
    Simulator<double>::Workspace workspace(simulator);
    NodeStates<double> state = simulator.MakeState(x, Points::Zero(3, 10));
    simulator.AdvanceFrame({hand, hand, {}}, &state, &workspace);
    return simulator.Positions(state);
  };
  Simulator<double> changed(first, environment, options);
  const Points before = end(changed);
  changed.SetParameters(second);
  EXPECT_EQ(end(changed), end(Simulator<double>(second, environment, options)));
  EXPECT_GT((end(changed) - before).norm(), 1e-3);
}

}  // namespace
}  // namespace physpring
