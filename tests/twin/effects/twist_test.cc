// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "twin/effects/registry.h"
#include "twin/effects/twist_section.h"

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
    force->Add({i * h, h, middle, velocity, {}}, angle, &unused);
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
  force->Add({0, 1e-3, Rod(0), still, {}}, angle, &on_straight);
  EXPECT_LT(on_straight.cwiseAbs().maxCoeff(), 1e-15);
  const Points bent = Rod(0.7);
  force->Add({0, 1e-3, bent, still, {}}, angle, &on_bent);
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

// A rod between two hands (8 and 9), with a branch at each of its nodes 1 and 2, in space.
//
//   8 - 0 - 1 - 2 - 3 - 9      4 and 5 from 1, 6 and 7 from 2
SpringMassSystem JoinedSystem() {
  SpringMassSystem system;
  system.position = Points::Zero(3, 10);
  const Vector places[10] = {{0.1, 0.02, 0},   {0.2, 0, 0.03},  {0.3, 0.01, 0},    {0.4, 0, 0.02},
                             {0.22, 0.1, 0},   {0.2, 0.2, 0.1}, {0.33, 0.02, 0.1}, {0.3, 0.1, 0.2},
                             {0, 0.01, -0.01}, {0.5, 0, 0}};
  for (int i = 0; i < 10; ++i) system.position.col(i) = places[i];
  system.controllers = 2;
  system.mass = Eigen::VectorXd::Ones(8);
  system.rod = RodOfEdges({{0, 8}, {0, 1}, {1, 2}, {2, 3}, {3, 9}, {1, 4}, {4, 5}, {2, 6}, {6, 7}},
                          system.position);
  return system;
}

// Rates of the angles of all sections, 1/s.
std::vector<double> Rates(const SpringMassSystem& system, const Points& v) {
  std::vector<double> rates;
  for (const TwistSection& section : FindTwistSections(system)) {
    rates.push_back(section.Slope(system.position).cwiseProduct(v).sum());
  }
  return rates;
}

Points Turning(const Points& x, const Vector& rate) {
  Points v(3, x.cols());
  for (int i = 0; i < x.cols(); ++i) v.col(i) = rate.cross(Vector(x.col(i)));
  return v;
}

// Hands are taken not to roll, so that the sections that they hold are twisted by what they do.
TEST(Twist, OfASectionBetweenJointsStaysWhenAllTurns) {
  const SpringMassSystem system = JoinedSystem();
  const Vector rate(0.3, -1, 2);
  const std::vector<double> rates = Rates(system, Turning(system.position, rate));
  ASSERT_EQ(rates.size(), 3U);
  const auto& x = system.position;
  std::vector<double> expected = {0, rate.dot((x.col(0) - x.col(8)).normalized()),
                                  -rate.dot((x.col(9) - x.col(3)).normalized())};
  // sections have no order or direction that matters
  for (const double one : rates) {
    const auto found = std::find_if(expected.begin(), expected.end(), [&](double other) {
      return std::abs(std::abs(one) - std::abs(other)) < 1e-12;
    });
    ASSERT_NE(found, expected.end()) << one;
    expected.erase(found);
  }
}

TEST(Twist, IsHowABranchTurnsAboutTheRod) {
  SpringMassSystem system = JoinedSystem();
  for (int i : {0, 1, 2, 3, 8, 9}) system.position.col(i).tail<2>().setZero();  // straight
  Points v = Points::Zero(3, 10);
  for (int i : {4, 5}) v.col(i) = Vector::UnitX().cross(Vector(system.position.col(i))) * 1.5;
  std::vector<double> rates = Rates(system, v);
  for (double& rate : rates) rate = std::abs(rate);
  std::sort(rates.begin(), rates.end());
  EXPECT_NEAR(rates[0], 0, 1e-12);
  EXPECT_NEAR(rates[1], 1.5, 1e-12);
  EXPECT_NEAR(rates[2], 1.5, 1e-12);
}

TEST(Twist, BetweenJointsIsBalanced) {
  const SpringMassSystem system = JoinedSystem();
  int balanced = 0;
  for (const TwistSection& section : FindTwistSections(system)) {
    const Points slope = section.Slope(system.position);
    EXPECT_LT(slope.rowwise().sum().norm(), 1e-12);
    Vector torque = Vector::Zero();
    for (int i = 0; i < 10; ++i)
      torque += Vector(system.position.col(i)).cross(Vector(slope.col(i)));
    if (section.is_held()) {
      EXPECT_NEAR(torque.norm(), 1, 1e-12);  // by which the hand turns it
    } else {
      EXPECT_LT(torque.norm(), 1e-12);
      ++balanced;
    }
  }
  EXPECT_EQ(balanced, 1);
}

TEST(Twist, TwoColumnsHaveNone) {
  SpringMassSystem system = RodSystem();
  system.position = system.position.leftCols(2).eval();
  system.mass = Eigen::VectorXd::Ones(2);
  system.rod = PlainRod(Eigen::Vector2d(0, 0.1));
  EXPECT_FALSE(GetEffect("twist").MakeForce(system, Eigen::Vector2d(1e-3, 1)));
}

TEST(Twist, BranchesWithAFreeEndHaveNone) {
  SpringMassSystem system = JoinedSystem();
  EXPECT_EQ(FindTwistSections(system).size(), 3U);
  TakeOut(9, &system.rod);
  EXPECT_EQ(FindTwistSections(system).size(), 2U);
  TakeOut(8, &system.rod);
  EXPECT_EQ(FindTwistSections(system).size(), 1U);
  system.rod = RodOfEdges({{0, 1}, {1, 2}, {1, 3}}, system.position);
  EXPECT_FALSE(HasTwistSections(system.rod, 8));
  EXPECT_FALSE(GetEffect("twist").MakeForce(system, Eigen::Vector2d(1e-3, 1)));
}

}  // namespace
}  // namespace physpring
