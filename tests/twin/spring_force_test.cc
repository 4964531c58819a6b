// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_force.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/spring_blocks.h"
#include "twin/spring_law.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

// Springs with the state of their nodes, and the forces on them.
template <class Real>
struct Springs {
  SpringBlocks<Real> blocks;
  NodeStates<Real> state;
  NodeForces<Real> force_bar;  // of the loss = sum of force_bar . force

  explicit Springs(const SpringMassSystem& system)
      : blocks(system), state(blocks.spare_node + 1), force_bar(blocks.spare_node + 1) {
    Random random(1);
    const int nodes = blocks.spare_node;
    const Points v = random.Box(nodes, 0.5), bar = random.Box(nodes, 1);
    for (int i = 0; i < nodes; ++i) {
      for (int j = 0; j < 3; ++j) {
        state[i].x[j] = static_cast<Real>(system.position(j, i));
        state[i].v[j] = static_cast<Real>(v(j, i));
        force_bar[i].f[j] = static_cast<Real>(bar(j, i));
      }
    }
  }

  NodeForces<Real> Forces() const {
    NodeForces<Real> force(state.size());
    AddSpringForces(blocks.View(), state.data(), force.data());
    return force;
  }
  long double Loss() const {
    const NodeForces<Real> force = Forces();
    long double loss = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      for (int j = 0; j < 3; ++j)
        loss += static_cast<long double>(force_bar[i].f[j]) * force[i].f[j];
    }
    return loss;
  }
  struct Gradient {
    NodeStates<Real> state;
    SpringBlockGradient<Real> springs;
  };
  void AddGradient(Gradient* gradient) const {
    AddSpringForcesAdjoint(blocks.View(), state.data(), force_bar.data(), gradient->state.data(),
                           gradient->springs.View());
  }
  Gradient LossGradient() const {
    Gradient gradient{NodeStates<Real>(state.size()), SpringBlockGradient<Real>(blocks.size())};
    AddGradient(&gradient);
    return gradient;
  }
};

Vector3d F(const NodeForce<double>& force) { return {force.f[0], force.f[1], force.f[2]}; }

// A spring of k = 50 N/m, L = 0.2 m, c = 3 N s/m between a at rest at the origin and b.
Springs<double> OneSpring(const Vector3d& x_b, const Vector3d& v_b) {
  Points position = Points::Zero(3, 2);
  position.col(1) = x_b;
  SpringMassSystem system = Particles(position, 1);
  AddSpring(0, 1, 50, 0.2, 3, &system);
  Springs<double> springs(system);
  for (int j = 0; j < 3; ++j) {
    springs.state[0].v[j] = 0;
    springs.state[1].v[j] = v_b[j];
  }
  return springs;
}

TEST(SpringForce, PullsWhenStretchedAndPushesWhenCompressed) {
  const Vector3d n = Vector3d(1, -2, 2) / 3;
  for (double length : {0.3, 0.2, 0.1}) {
    const auto force = OneSpring(length * n, {0, 0, 0}).Forces();
    EXPECT_NEAR((F(force[0]) - 50 * (length - 0.2) * n).norm(), 0, 1e-14);
    EXPECT_EQ(F(force[1]), -F(force[0]));
  }
}

TEST(SpringForce, DampsOnlyAlongTheSpring) {
  const Vector3d n = Vector3d(1, -2, 2) / 3;
  const auto force = OneSpring(0.2 * n, 0.7 * n + 5 * n.unitOrthogonal()).Forces();
  EXPECT_NEAR((F(force[0]) - 3 * 0.7 * n).norm(), 0, 1e-14);
  EXPECT_EQ(F(force[1]), -F(force[0]));
}

TEST(SpringForce, OfASpringWithoutLengthIsZero) {
  for (double length : {0.0, 0.5 * kShortest}) {
    const auto force = OneSpring({length, 0, 0}, {1, 2, 3}).Forces();
    EXPECT_EQ(F(force[0]), Vector3d(0, 0, 0)) << length;
    EXPECT_EQ(F(force[1]), Vector3d(0, 0, 0)) << length;
  }
}

TEST(SpringForce, AddsTensionThatPulls) {
  const Vector3d n = Vector3d(1, -2, 2) / 3;
  const Springs<double> springs = OneSpring(0.2 * n, {0, 0, 0});
  std::vector<double> tension(springs.blocks.size());
  tension[0] = 7;  // of the spring; the rest is filling
  SpringView<double> view = springs.blocks.View();
  view.tension = tension.data();
  NodeForces<double> force(springs.state.size());
  AddSpringForces(view, springs.state.data(), force.data());
  EXPECT_NEAR((F(force[0]) - 7 * n).norm(), 0, 1e-14);
  EXPECT_EQ(F(force[1]), -F(force[0]));
}

TEST(SpringForce, MeasuresLengthRateAndWhatTensionDoes) {
  const Vector3d n = Vector3d(1, -2, 2) / 3;
  const Springs<double> springs = OneSpring(0.3 * n, 0.7 * n + 5 * n.unitOrthogonal());
  const int size = springs.blocks.size();
  std::vector<double> length(size), rate(size), tension_bar(size);
  MeasureSprings(springs.blocks.View(), springs.state.data(), springs.force_bar.data(),
                 {length.data(), rate.data(), tension_bar.data()});
  EXPECT_NEAR(length[0], 0.3, 1e-15);
  EXPECT_NEAR(rate[0], 0.7, 1e-15);
  // the ends are pulled together: the force on the first one is T n
  EXPECT_NEAR(tension_bar[0], n.dot(F(springs.force_bar[0]) - F(springs.force_bar[1])), 1e-15);
}

TEST(SpringForce, AddsToWhatIsThere) {
  const Springs<double> springs(RandomSystem(8, 1, 2));
  NodeForces<double> twice = springs.Forces();
  const NodeForces<double> once = twice;
  AddSpringForces(springs.blocks.View(), springs.state.data(), twice.data());
  for (int i = 0; i < springs.blocks.spare_node; ++i) {
    EXPECT_NEAR((F(twice[i]) - 2 * F(once[i])).norm(), 0, 1e-14 * F(once[i]).norm());
  }
}

// Against differences, with steps relative to `length`, the length of the springs.
std::vector<GradientReport> CheckGradients(Springs<double>* springs, double length) {
  const Springs<double>::Gradient gradient = springs->LossGradient();
  const int nodes = springs->blocks.spare_node;
  std::vector<CheckedVariable> x, v, k, L, c;
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::string name = fmt::format("{}.{}", i, j);
      x.push_back({"x" + name, &springs->state[i].x[j], 1e-3 * length, gradient.state[i].x[j]});
      v.push_back({"v" + name, &springs->state[i].v[j], 1e-3, gradient.state[i].v[j]});
    }
  }
  SpringBlocks<double>& blocks = springs->blocks;
  for (int e = 0; e < blocks.size(); ++e) {
    if (blocks.spring[e] < 0) continue;
    k.push_back({fmt::format("k{}", e), &blocks.stiffness[e], 1e-1, gradient.springs.stiffness[e]});
    L.push_back(
        {fmt::format("L{}", e), &blocks.rest_length[e], 1e-4, gradient.springs.rest_length[e]});
    c.push_back({fmt::format("c{}", e), &blocks.dashpot[e], 1e-3, gradient.springs.dashpot[e]});
  }
  std::vector<GradientReport> reports;
  for (const auto& variables : {x, v, k, L, c}) {
    reports.push_back(CheckGradient([&] { return springs->Loss(); }, variables));
  }
  return reports;
}

TEST(SpringForceAdjoint, MatchesDifferences) {
  Springs<double> springs(RandomSystem(8, 1, 2));
  for (const GradientReport& report : CheckGradients(&springs, 0.1)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

// Just longer than kShortest a spring has its full force, and that turns with the nodes: its
// derivative is 1 / l times larger than usual.
TEST(SpringForceAdjoint, MatchesDifferencesAboveTheShortestLength) {
  Springs<double> springs = OneSpring(Vector3d(1.2, -2.4, 2.4) * kShortest / 3, {0.1, 0.2, 0.3});
  for (const GradientReport& report : CheckGradients(&springs, kShortest)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

TEST(SpringForceAdjoint, MatchesDifferencesBelowTheShortestLength) {
  for (double length : {0.0, 0.7 * kShortest}) {
    Springs<double> springs = OneSpring(Vector3d(1, -2, 2) * length / 3, {0.1, 0.2, 0.3});
    for (const GradientReport& report : CheckGradients(&springs, kShortest)) {
      EXPECT_TRUE(report.passed) << report.log;
    }
    const NodeState<double> bar = springs.LossGradient().state[1];
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(bar.x[j], 0) << length;
      EXPECT_EQ(bar.v[j], 0) << length;
    }
  }
}

// <force_bar, J ds> = <J^T force_bar, ds> for a random change ds of the whole state.
TEST(SpringForceAdjoint, PassesTheDotProductTest) {
  const Springs<double> springs(RandomSystem(30, 2, 3));
  const Springs<double>::Gradient gradient = springs.LossGradient();
  Random random(4);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Points dx = random.Box(32, 1e-2), dv = random.Box(32, 1);
    const auto moved = [&](double step) {
      Springs<double> result = springs;
      for (int i = 0; i < 32; ++i) {
        for (int j = 0; j < 3; ++j) {
          result.state[i].x[j] += step * dx(j, i);
          result.state[i].v[j] += step * dv(j, i);
        }
      }
      return result.Loss();
    };
    double expected = 0;
    for (int i = 0; i < 32; ++i) {
      for (int j = 0; j < 3; ++j) {
        expected += gradient.state[i].x[j] * dx(j, i) + gradient.state[i].v[j] * dv(j, i);
      }
    }
    const double step = 1e-5;
    const double difference = static_cast<double>(moved(step) - moved(-step)) / (2 * step);
    EXPECT_NEAR(difference, expected, 1e-8 * std::abs(expected));
  }
}

TEST(SpringForceAdjoint, AddsToWhatIsThere) {
  const Springs<double> springs(RandomSystem(8, 1, 2));
  const Springs<double>::Gradient once = springs.LossGradient();
  Springs<double>::Gradient twice = once;
  springs.AddGradient(&twice);
  for (int i = 0; i < springs.blocks.spare_node; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(twice.state[i].x[j], 2 * once.state[i].x[j], 1e-11);  // of about 1e3
      EXPECT_NEAR(twice.state[i].v[j], 2 * once.state[i].v[j], 1e-13);
    }
  }
  for (int e = 0; e < springs.blocks.size(); ++e) {
    EXPECT_EQ(twice.springs.stiffness[e], 2 * once.springs.stiffness[e]);
    EXPECT_EQ(twice.springs.rest_length[e], 2 * once.springs.rest_length[e]);
    EXPECT_EQ(twice.springs.dashpot[e], 2 * once.springs.dashpot[e]);
  }
}

TEST(SpringForce, OfFloatIsThatOfDouble) {
  const SpringMassSystem system = RandomSystem(30, 2, 3);
  const Springs<double> exact(system);
  const Springs<float> rounded(system);
  const auto force = exact.Forces();
  const auto rounded_force = rounded.Forces();
  const auto bar = exact.LossGradient();
  const auto rounded_bar = rounded.LossGradient();
  double largest = 0, force_error = 0, largest_bar = 0, bar_error = 0;
  for (int i = 0; i < 32; ++i) {
    for (int j = 0; j < 3; ++j) {
      largest = std::max(largest, std::abs(force[i].f[j]));
      force_error = std::max(force_error, std::abs(force[i].f[j] - rounded_force[i].f[j]));
      largest_bar = std::max(largest_bar, std::abs(bar.state[i].x[j]));
      bar_error = std::max(bar_error, std::abs(bar.state[i].x[j] - rounded_bar.state[i].x[j]));
    }
  }
  // a float has 6e-8, and the difference of positions at 0.1 m loses a digit
  EXPECT_LT(force_error, 2e-6 * largest);
  EXPECT_LT(bar_error, 2e-6 * largest_bar);
}

}  // namespace
}  // namespace physpring
