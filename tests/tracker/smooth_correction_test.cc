// SPDX-License-Identifier: Apache-2.0
#include "tracker/smooth_correction.h"

#include <gtest/gtest.h>

#include <cmath>

namespace physpring {
namespace {

// A row of nodes, each joined to the next one; the last joined to a controller, if there is one.
SpringMassSystem Row(int nodes, bool held) {
  SpringMassSystem system;
  system.controllers = held ? 1 : 0;
  system.position = Points::Zero(3, nodes + system.controllers);
  for (int i = 0; i < system.position.cols(); ++i) system.position(0, i) = 0.1 * i;
  system.mass = Eigen::VectorXd::Constant(nodes, 0.01);
  for (int i = 0; i + 1 < system.position.cols(); ++i) system.springs.push_back({i, i + 1});
  const auto springs = static_cast<Eigen::Index>(system.springs.size());
  system.stiffness = Eigen::VectorXd::Constant(springs, 100);
  system.rest_length = Eigen::VectorXd::Constant(springs, 0.1);
  system.dashpot = Eigen::VectorXd::Zero(springs);
  return system;
}

Points Offset(int nodes, int measured, const Eigen::Vector3d& r) {
  Points offset = Points::Zero(3, nodes);
  offset.col(measured) = r;
  return offset;
}

TEST(SmoothCorrection, MovesAFreeBodyAsAWhole) {
  const SmoothCorrection correction(Row(6, false));
  const Eigen::Vector3d r(0.01, -0.02, 0.03);
  const Points d = correction.Solve(Offset(6, 2, r), Eigen::VectorXd::Unit(6, 2) * 1e6, 1e-3);
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(d.col(i).isApprox(r, 1e-5)) << i;
}

TEST(SmoothCorrection, LetsNodesBetweenMeasuredOnesMoveAlong) {
  const SmoothCorrection correction(Row(5, false));
  Eigen::VectorXd precision = Eigen::VectorXd::Zero(5);
  Points offset = Points::Zero(3, 5);
  for (int i : {0, 4}) {
    precision[i] = 1e6;
    offset(2, i) = 0.02;
  }
  const Points d = correction.Solve(offset, precision, 1e-2);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(d(2, i), 0.02, 1e-4) << i;
}

TEST(SmoothCorrection, FallsOffTowardsAController) {
  const SmoothCorrection correction(Row(6, true));
  const Eigen::VectorXd precision = Eigen::VectorXd::Unit(6, 0) * 1e6;
  const Points d = correction.Solve(Offset(6, 0, {0, 0, 0.02}), precision, 1);
  EXPECT_NEAR(d(2, 0), 0.02, 1e-3);
  for (int i = 0; i + 1 < 6; ++i) EXPECT_GT(d(2, i), d(2, i + 1)) << i;
  EXPECT_LT(d(2, 5), 0.01);
}

TEST(SmoothCorrection, SeesOnlyWhatIsWideCoarsely) {
  constexpr int kNodes = 120;
  const SmoothCorrection correction(Row(kNodes, false));
  const Eigen::VectorXd precision = Eigen::VectorXd::Constant(kNodes, 1e6);
  const auto coarse = SmoothCorrection::Detail::kCoarse;
  Points wide = Points::Zero(3, kNodes);
  for (int i = 0; i < kNodes; ++i) wide(2, i) = 0.02 * std::cos(M_PI * (i + 0.5) / kNodes);
  EXPECT_TRUE(correction.Solve(wide, precision, 1, coarse).isApprox(wide, 1e-3));
  const Points dent = Offset(kNodes, 60, {0, 0, 0.02});
  EXPECT_LT(correction.Solve(dent, precision, 1e3, coarse)(2, 60), 0.3 * 0.02);
  EXPECT_GT(correction.Solve(dent, precision, 1e3)(2, 60), 0.7 * 0.02);
}

TEST(SmoothCorrection, TrustsAGoodModelMore) {
  const SmoothCorrection correction(Row(6, true));
  const Eigen::VectorXd precision = Eigen::VectorXd::Unit(6, 3) * 1e6;  // noise of 1 mm
  const Points offset = Offset(6, 3, {0, 0.02, 0});
  const double bad = correction.Solve(offset, precision, 1)(1, 3);
  const double good = correction.Solve(offset, precision, 1e-5)(1, 3);
  EXPECT_NEAR(bad, 0.02, 1e-4);
  EXPECT_LT(good, 0.2 * bad);
}

TEST(SmoothCorrection, StaysWhereNothingIsMeasured) {
  const SmoothCorrection correction(Row(4, true));
  EXPECT_TRUE(correction.Solve(Offset(4, 1, {1, 1, 1}), Eigen::VectorXd::Zero(4), 1).isZero(0));
}

}  // namespace
}  // namespace physpring
