// SPDX-License-Identifier: Apache-2.0
// Nodes in contact for one sub-step, and the check of that sub-step's adjoint by differences.
#ifndef PHYSPRING_TESTS_SUPPORT_CONTACT_SCENE_H_
#define PHYSPRING_TESTS_SUPPORT_CONTACT_SCENE_H_

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/contact.h"

namespace physpring {

inline constexpr double kStep = 1e-3;     // h, s
inline constexpr double kElapsed = 0.02;  // since the start of the frame, s

inline NodeStates<double> StateAt(const Points& x, const Points& v) {
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
inline std::vector<GradientReport> CheckGradients(Scene scene) {
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
  std::vector<CheckedVariable> laws;
  for (const auto& [name, object_name, most, member] : kContactCoefficients<double>) {
    laws.push_back({name, &(c.surface.*member), 1e-4, gradient.laws.surface.*member});
    laws.push_back({object_name, &(c.object.*member), 1e-4, gradient.laws.object.*member});
  }
  std::vector<GradientReport> reports;
  for (const auto& variables : {x, v, mass, laws}) {
    reports.push_back(CheckGradient(loss, variables));
  }
  return reports;
}

inline void ExpectGradientsMatch(const Scene& scene) {
  for (const GradientReport& report : CheckGradients(scene)) {
    EXPECT_TRUE(report.passed) << report.log;
  }
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_CONTACT_SCENE_H_
