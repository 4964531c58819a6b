// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "twin/effects/registry.h"

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;

// Four edges of 0.1 m along z, of which the second turns to x and the third to y, both along great
// circles, while the first and the last only move.
Points Rod(double angle) {
  const Vector z = Vector::UnitZ();
  const Vector edges[4] = {z, std::cos(angle) * z + std::sin(angle) * Vector::UnitX(),
                           std::cos(angle) * z + std::sin(angle) * Vector::UnitY(), z};
  Points x = Points::Zero(3, 5);
  for (int i = 0; i < 4; ++i) x.col(i + 1) = x.col(i) + 0.1 * edges[i];
  return x;
}

SpringMassSystem RodSystem() {
  SpringMassSystem system;
  system.position = Rod(0);
  system.mass = Eigen::VectorXd::Ones(5);
  system.rod = PlainRod(Eigen::VectorXd::LinSpaced(5, 0, 0.4));
  return system;
}

// The frame that is carried along z, x, y and z turns by the octant of the sphere that these go
// around.
TEST(Twist, AngleIsTheSolidAngleOfTheTangents) {
  const SpringMassSystem system = RodSystem();
  const auto force = GetEffect("twist").MakeForce(system, Eigen::Vector2d(1e-3, 0));
  ASSERT_TRUE(force);
  Eigen::VectorXd angle = Eigen::VectorXd::Zero(1);
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double h = 1.0 / kSteps;
    const Points before = Rod(M_PI / 2 * i * h), after = Rod(M_PI / 2 * (i + 1) * h);
    const Points middle = (before + after) / 2, velocity = (after - before) / h;
    Points unused = Points::Zero(3, 5);
    force->Add({i * h, h, middle, velocity}, angle, &unused);
  }
  EXPECT_NEAR(std::abs(angle[0]), M_PI / 2, 1e-3);
}

// A straight rod that is turned feels nothing; a bent one no force and no torque as a whole.
TEST(Twist, ForcesAreBalanced) {
  const SpringMassSystem system = RodSystem();
  const auto force = GetEffect("twist").MakeForce(system, Eigen::Vector2d(1e-3, 2));
  Eigen::VectorXd angle = Eigen::VectorXd::Zero(1);
  const Points still = Points::Zero(3, 5);
  Points on_straight = still, on_bent = still;
  force->Add({0, 1e-3, Rod(0), still}, angle, &on_straight);
  EXPECT_LT(on_straight.cwiseAbs().maxCoeff(), 1e-15);
  const Points bent = Rod(0.7);
  force->Add({0, 1e-3, bent, still}, angle, &on_bent);
  EXPECT_GT(on_bent.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(on_bent.rowwise().sum().norm(), 1e-15);
  Vector torque = Vector::Zero();
  for (int i = 0; i < 5; ++i) torque += Vector(bent.col(i)).cross(Vector(on_bent.col(i)));
  // what is left is what the hands hold against: the torque T along both ends, which cancels here
  EXPECT_LT(torque.norm(), 1e-12);
}

TEST(Twist, ActsOnRodsOnly) {
  SpringMassSystem system = RodSystem();
  system.rod = {};
  EXPECT_FALSE(GetEffect("twist").MakeForce(system, Eigen::Vector2d(1e-3, 1)));
}

}  // namespace
}  // namespace physpring
