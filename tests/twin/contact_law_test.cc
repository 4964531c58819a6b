// SPDX-License-Identifier: Apache-2.0
#include "twin/contact_law.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

const Vector3d kUp(0, 0, 1);

TEST(ContactLaw, RestitutionTurnsTheNormalVelocity) {
  const Vector3d after = Impact<double>({0, 0, -2}, kUp, {.restitution = 0.25, .friction = 0.5});
  EXPECT_EQ(after, Vector3d(0, 0, 0.5));
}

TEST(ContactLaw, FrictionTakesMuTimesTheNormalImpulse) {
  // normal impulse a mass (1 + e) |u_n| = 3, of which friction takes 0.1 from the 4 m/s of sliding
  const Vector3d after = Impact<double>({0, 4, -2}, kUp, {.restitution = 0.5, .friction = 0.1});
  EXPECT_NEAR((after - Vector3d(0, 3.7, 1)).norm(), 0, 1e-15);
}

TEST(ContactLaw, FrictionStopsButDoesNotTurnTheSliding) {
  const Vector3d after = Impact<double>({0.3, 0.4, -2}, kUp, {.restitution = 0, .friction = 2});
  EXPECT_EQ(after, Vector3d(0, 0, 0));
}

TEST(ContactLaw, ThePyramidTakesTheFasterTangentFirst) {
  const auto after = [](const Vector3d& sliding, double friction) {
    // normal impulse a mass (1 + e) |u_n| = 1
    return Impact<double>(sliding - kUp, kUp, {0, friction, FrictionCone::kPyramidal});
  };
  EXPECT_NEAR((after({-1, 0.25, 0}, 0.5) - Vector3d(-0.5, 0.25, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((after({0.25, 1, 0}, 1) - Vector3d(0.125, 0.125, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(after({0.5, -1, 0}, 1.5), Vector3d(0, 0, 0));
  EXPECT_EQ(after({0.5, -1, 0}, 0), Vector3d(0.5, -1, 0));
}

// On a wall with |n_y| >= 0.5 the tangents are z and n x z.
TEST(ContactLaw, ThePyramidStandsOnWallsAsMujocosDoes) {
  const Vector3d after =
      Impact<double>({0.25, -1, 1}, Vector3d::UnitY(), {0, 0.5, FrictionCone::kPyramidal});
  EXPECT_NEAR((after - Vector3d(0.25, 0, 0.5)).norm(), 0, 1e-15);
}

TEST(ContactLaw, NoFrictionKeepsTheSliding) {
  const Vector3d after = Impact<double>({3, 4, -2}, kUp, {.restitution = 0, .friction = 0});
  EXPECT_EQ(after, Vector3d(3, 4, 0));
}

TEST(ContactLaw, NeverAddsEnergy) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d n = random.Box(1, 1).col(0).normalized();
    Vector3d u = random.Box(1, 1).col(0);
    if (u.dot(n) > 0) u = -u;
    ContactPair<double> law{random(0, 1), random(0, 2)};
    EXPECT_LE(Impact(u, n, law).norm(), u.norm() * (1 + 1e-15));
    law.cone = FrictionCone::kPyramidal;
    EXPECT_LE(Impact(u, n, law).norm(), u.norm() * (1 + 1e-15));
  }
}

// The gradient of bar . Impact(u, n) against differences, in units of `speed`.
GradientReport CheckImpact(Vector3d u, Vector3d n, ContactPair<double> law, double speed) {
  const Vector3d bar(0.3, -0.7, 0.5);
  u *= speed;
  Vector3d u_bar = Vector3d::Zero(), n_bar = Vector3d::Zero();
  ContactPair<double> law_bar;
  ImpactAdjoint(u, n, law, bar, &u_bar, &n_bar, &law_bar);
  const auto loss = [&] { return static_cast<long double>(bar.dot(Impact(u, n, law))) / speed; };
  std::vector<CheckedVariable> variables;
  for (int j = 0; j < 3; ++j) {
    variables.push_back({fmt::format("u{}", j), &u[j], 1e-4 * speed, u_bar[j] / speed});
  }
  GradientReport report = CheckGradient(loss, variables);
  variables.clear();
  for (int j = 0; j < 3; ++j) {
    variables.push_back({fmt::format("n{}", j), &n[j], 1e-4, n_bar[j] / speed});
  }
  for (const auto& [name, object_name, most, member] : kContactCoefficients<double>) {
    variables.push_back({name, &(law.*member), 1e-4, law_bar.*member / speed});
  }
  const GradientReport rest = CheckGradient(loss, variables);
  report.passed = report.passed && rest.passed;
  report.log += rest.log;
  return report;
}

const Vector3d kTilted = Vector3d(1, 2, 3).normalized();

TEST(ContactLawAdjoint, MatchesDifferencesWhenSliding) {
  const GradientReport report = CheckImpact({1, -0.5, -0.6}, kTilted, {0.4, 0.3}, 1);
  EXPECT_TRUE(report.passed) << report.log;
}

// Tangential speeds 0.86 and 0.5 m/s along the tangents, u_n = -0.6 m/s.
TEST(ContactLawAdjoint, MatchesDifferencesInEachPartOfThePyramid) {
  const Vector3d u = -0.6 * kTilted + 0.86 * kTilted.cross(Vector3d::UnitZ()).normalized() -
                     0.5 * kTilted.cross(kTilted.cross(Vector3d::UnitZ())).normalized();
  for (const Vector3d& sliding : {u, Vector3d(-1.2 * kTilted - u)}) {
    for (double friction : {0.1, 0.8, 1.9}) {  // one tangent is slowed, both are, it sticks
      const GradientReport report =
          CheckImpact(sliding, kTilted, {0.4, friction, FrictionCone::kPyramidal}, 1);
      EXPECT_TRUE(report.passed) << friction << "\n" << report.log;
    }
  }
}

TEST(ContactLawAdjoint, MatchesDifferencesWhenSticking) {
  const GradientReport report = CheckImpact({1, -0.5, -0.6}, kTilted, {0.4, 1.9}, 1);
  EXPECT_TRUE(report.passed) << report.log;
}

// Sliding slower than kSliding = 1e-6 m/s, where the law takes kSliding instead: friction is then
// viscous. The other side of that kink is MatchesDifferencesWhenSliding, at any speed.
TEST(ContactLawAdjoint, MatchesDifferencesBelowTheSlidingThreshold) {
  const Vector3d u = -0.2 * kTilted + 0.9 * kTilted.unitOrthogonal();
  const GradientReport below = CheckImpact(u, kTilted, {0.4, 0.3}, kSliding);
  EXPECT_TRUE(below.passed) << below.log;
  const GradientReport above = CheckImpact(u, kTilted, {0.4, 0.3}, 1.3 * kSliding);
  EXPECT_TRUE(above.passed) << above.log;
}

TEST(ContactLawAdjoint, OfAHeadOnImpactIsFinite) {
  Vector3d u_bar = Vector3d::Zero(), n_bar = Vector3d::Zero();
  ContactPair<double> law_bar;
  ImpactAdjoint<double>({0, 0, -1}, kUp, {0.5, 0.3}, {1, 1, 1}, &u_bar, &n_bar, &law_bar);
  EXPECT_EQ(u_bar, Vector3d(0, 0, -0.5));  // sticks: the sliding has no say
  EXPECT_EQ(law_bar.restitution, 1);
  EXPECT_EQ(law_bar.friction, 0);
}

// <bar, J du> = <J^T bar, du> for random directions, the left side from a difference.
TEST(ContactLawAdjoint, PassesTheDotProductTest) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Vector3d n = random.Box(1, 1).col(0).normalized();
    Vector3d u = random.Box(1, 1).col(0);
    if (u.dot(n) > 0) u = -u;
    const ContactPair<double> law{random(0, 1), random(0, 0.5)};
    const Vector3d du = random.Box(1, 1).col(0), bar = random.Box(1, 1).col(0);
    // away from the kink between sliding and sticking
    const double kept = 1 + law.friction * (1 + law.restitution) * u.dot(n) / u.cross(n).norm();
    if (std::abs(kept) < 0.01 || u.cross(n).norm() < 0.01) continue;
    Vector3d u_bar = Vector3d::Zero(), n_bar = Vector3d::Zero();
    ContactPair<double> law_bar;
    ImpactAdjoint(u, n, law, bar, &u_bar, &n_bar, &law_bar);
    const double step = 1e-6;
    const Vector3d change =
        (Impact<double>(u + step * du, n, law) - Impact<double>(u - step * du, n, law)) /
        (2 * step);
    EXPECT_NEAR(bar.dot(change), u_bar.dot(du), 1e-8);
  }
}

TEST(ContactLawAdjoint, AddsToWhatIsThere) {
  const Vector3d u(1, 0.2, -1), bar(1, 2, 3);
  const ContactPair<double> law{0.5, 0.1};
  Vector3d u_bar = Vector3d::Zero(), n_bar = Vector3d::Zero();
  ContactPair<double> law_bar;
  ImpactAdjoint(u, kUp, law, bar, &u_bar, &n_bar, &law_bar);
  Vector3d u_sum = u_bar, n_sum = n_bar;
  ContactPair<double> law_sum = law_bar;
  ImpactAdjoint(u, kUp, law, bar, &u_sum, &n_sum, &law_sum);
  EXPECT_NEAR((u_sum - 2 * u_bar).norm(), 0, 1e-14);
  EXPECT_NEAR((n_sum - 2 * n_bar).norm(), 0, 1e-14);
  EXPECT_DOUBLE_EQ(law_sum.restitution, 2 * law_bar.restitution);
  EXPECT_DOUBLE_EQ(law_sum.friction, 2 * law_bar.friction);
}

}  // namespace
}  // namespace physpring
