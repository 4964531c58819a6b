// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "twin/effects/bend_effect.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

constexpr double kLength = 0.4, kMoment = 1e-3, kSlip = 2;  // m, N m, 1/m

// A rod of this many edges along an arc of this curvature in the plane of x and z.
Points Arc(int edges, double curvature) {
  const double edge = kLength / edges;
  Points x = Points::Zero(3, edges + 1);
  for (int i = 0; i < edges; ++i) {
    const double angle = curvature * edge * i;
    x.col(i + 1) = x.col(i) + edge * Eigen::Vector3d(std::cos(angle), 0, std::sin(angle));
  }
  return x;
}

// The moment, N m, at the first triple of a rod that was straight and is bent to this curvature.
double MomentOf(int edges, double curvature) {
  SpringMassSystem system;
  system.position = Arc(edges, 0);
  system.mass = Eigen::VectorXd::Ones(edges + 1);
  system.rod = PlainRod(Eigen::VectorXd::LinSpaced(edges + 1, 0, kLength));
  const auto moment =
      GetEffect("bending_friction").MakeBend(system, Eigen::Vector2d(kMoment, kSlip));
  Eigen::VectorXd internal = Eigen::VectorXd::Zero(moment->internal_size());
  constexpr int kSteps = 400;
  const double h = 1.0 / kSteps;
  Points total;
  for (int i = 0; i < kSteps; ++i) {
    const Points before = Arc(edges, curvature * i * h),
                 after = Arc(edges, curvature * (i + 1) * h);
    total = Points::Zero(3, edges + 1);
    AddBendForces({{moment.get(), 0}}, {i * h, h, (before + after) / 2, (after - before) / h, {}},
                  internal, &total);
  }
  return total.col(0).norm() * kLength / edges;
}

TEST(BendingFriction, GivesWayAtACurvatureHoweverFineTheRod) {
  for (int edges : {4, 8, 16}) {
    EXPECT_NEAR(MomentOf(edges, 0.5 * kSlip), 0.5 * kMoment, 0.01 * kMoment) << edges;
    EXPECT_NEAR(MomentOf(edges, 1.5 * kSlip), kMoment, 0.02 * kMoment) << edges;
  }
}

}  // namespace
}  // namespace physpring
