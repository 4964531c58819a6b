// SPDX-License-Identifier: Apache-2.0
#include "tests/support/gradient_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace physpring {
namespace {

// loss = x^3 y + exp(-y) at (1.5, 0.5), with the derivatives scaled by (x_factor, y_factor).
GradientReport CheckScaled(double x_factor, double y_factor) {
  double x = 1.5, y = 0.5;
  const auto loss = [&] { return x * x * x * y + std::exp(-y); };
  return CheckGradient(loss, {{"x", &x, 1e-3, x_factor * (3 * x * x * y)},
                              {"y", &y, 1e-3, y_factor * (x * x * x - std::exp(-y))}});
}

TEST(GradientCheck, AcceptsTheDerivative) {
  const GradientReport report = CheckScaled(1, 1);
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_LT(report.worst_error, 1e-9);
}

TEST(GradientCheck, RejectsAWrongSign) {
  EXPECT_FALSE(CheckScaled(-1, 1).passed);
  EXPECT_FALSE(CheckScaled(1, -1).passed);
}

TEST(GradientCheck, RejectsAWrongFactor) {
  EXPECT_FALSE(CheckScaled(1.001, 1).passed);
  EXPECT_FALSE(CheckScaled(1, 1 - 3e-6).passed);
}

TEST(GradientCheck, RejectsAMissingDerivative) { EXPECT_FALSE(CheckScaled(0, 1).passed); }

TEST(GradientCheck, RejectsNotANumber) {
  EXPECT_FALSE(CheckScaled(std::numeric_limits<double>::quiet_NaN(), 1).passed);
  double x = 1;
  const auto loss = [] { return std::numeric_limits<long double>::quiet_NaN(); };
  EXPECT_FALSE(CheckGradient(loss, {{"x", &x, 1e-3, 0}}).passed);
}

TEST(GradientCheck, DoubtsADifferenceAcrossAJump) {
  double x = 0;
  const auto loss = [&] { return x < 1e-4 ? 2 * x : 2 * x + 1; };
  const GradientReport report = CheckGradient(loss, {{"x", &x, 1e-3, 2}});
  EXPECT_FALSE(report.passed);
  EXPECT_GT(report.worst_doubt, 0.1);
}

TEST(GradientCheck, PutsTheVariableBack) {
  double x = 0.1;
  CheckGradient([&] { return x * x; }, {{"x", &x, 1e-3, 0.2}});
  EXPECT_EQ(x, 0.1);
}

TEST(GradientCheck, LogsBothValues) {
  double x = 2;
  const auto report = CheckGradient([&] { return x * x; }, {{"speed", &x, 1e-3, 5}});
  EXPECT_NE(report.log.find("FAIL speed: derivative 5, numeric 4"), std::string::npos)
      << report.log;
}

}  // namespace
}  // namespace physpring
