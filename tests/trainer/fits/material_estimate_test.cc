// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/material_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/simulation.h"

namespace physpring {
namespace {

// A triangle of springs of three lengths, held by a controller's spring of a length of its own.
SpringMassSystem HeldTriangle() {
  SpringMassSystem system = Particles(Points::Random(3, 4), 0.01);
  system.controllers = 1;
  system.mass.conservativeResize(3);
  system.contact_radius.conservativeResize(3);
  AddSpring(0, 1, 30, 0.1, 0.03, &system);
  AddSpring(1, 2, 15, 0.2, 0.015, &system);
  AddSpring(0, 2, 10, 0.3, 0.01, &system);
  AddSpring(0, 3, 500, 0.01, 0.5, &system);
  system.drag = 2;
  return system;
}

// The stiffness is known to 10 %, by one number of the posterior.
Posterior KnownStiffness(const SpringMassSystem& system) {
  const int springs = system.spring_count();
  Posterior posterior;
  posterior.stiffness = Eigen::MatrixXd::Constant(1, springs, 0.1);
  posterior.loss_time = Eigen::MatrixXd::Zero(1, springs);
  posterior.drag = Eigen::VectorXd::Zero(1);
  posterior.contact = Eigen::MatrixXd::Zero(1, kContactCount);
  posterior.effects = Eigen::MatrixXd::Zero(1, 0);
  return posterior;
}

TEST(MaterialEstimate, IsOfTheObjectsSpringsByLength) {
  const SpringMassSystem system = HeldTriangle();
  const Material material = EstimateMaterial(system, KnownStiffness(system));
  ASSERT_EQ(material.classes.size(), 3u);
  for (const auto& one : material.classes) {
    EXPECT_EQ(one.springs, 1);
    EXPECT_NEAR(one.axial_stiffness.value, 3, 1e-9);
    EXPECT_NEAR(one.axial_stiffness.high, 3 * std::exp(1.645 * 0.1), 1e-4);
  }
  EXPECT_NEAR(material.classes[0].shortest, 0.1, 1e-12);
  EXPECT_NEAR(material.loss_time.value, 1e-3, 1e-12);
  EXPECT_NEAR(material.drag.high, 2, 1e-9);
}

}  // namespace
}  // namespace physpring
