// SPDX-License-Identifier: Apache-2.0
#include "twin/lift.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/small_twin.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

Points StartOf(const Twin& twin) {
  const SpringMassSystem& system = twin.levels[0].system;
  return system.position.leftCols(system.node_count());
}

TEST(Lift, IsTheIdentityAtLevel0) {
  const Twin twin = SmallTwin(2);
  const Points nodes = Points::Random(3, 40);
  EXPECT_EQ(Lift(twin, 0, StartOf(twin)).Apply(nodes), nodes);
}

TEST(Lift, GivesTheStartBack) {
  const Twin twin = SmallTwin(3);
  const Points start = StartOf(twin) + 0.003 * Points::Random(3, 40);  // not the twin's own
  for (int level : {1, 2}) {
    const Points lifted = Lift(twin, level, start).Apply(AverageOverMembers(twin, level, start));
    EXPECT_LT((lifted - start).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST(Lift, FollowsARigidMotion) {
  const Twin twin = SmallTwin(3);
  const Points start = StartOf(twin);
  const Eigen::AngleAxisd rotation(2, Eigen::Vector3d(1, -2, 0.5).normalized());
  const Eigen::Vector3d shift(0.3, -0.1, 0.2);
  const Points moved = (rotation.toRotationMatrix() * start).colwise() + shift;
  const Points lifted = Lift(twin, 1, start).Apply(AverageOverMembers(twin, 1, moved));
  // the planar neighbourhoods of level 1 determine their rotation; 20 mm of arm
  EXPECT_LT((lifted - moved).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Lift, BlendsTheFourNearestNodesByDistance) {
  const Twin twin = SmallTwin(2);
  const Points start = StartOf(twin);
  Points nodes = AverageOverMembers(twin, 1, start);
  // particle 0 lies in node 0, at the corner of the block; a node that is not near does not move it
  nodes.col(19) += Eigen::Vector3d(0, 0, 0.01);
  const Points lifted = Lift(twin, 1, start).Apply(nodes);
  EXPECT_LT((lifted.col(0) - start.col(0)).norm(), 1e-15);
  // its own members move most of the way up
  EXPECT_GT(lifted(2, 19) - start(2, 19), 0.005);
  EXPECT_LT(lifted(2, 19) - start(2, 19), 0.01);
}

// A bent block, and one whose nodes lie about on a straight line (a rope: the twist is open).
TEST(Lift, AdjointIsTheDerivative) {
  for (const bool straight : {false, true}) {
    Twin twin = SmallTwin(2);
    if (straight) {
      SpringMassSystem& level0 = twin.levels[0].system;
      level0.position.bottomRows(2) *= 1e-3;
      const Points particles = level0.position.leftCols(level0.node_count());
      SpringMassSystem& level1 = twin.levels[1].system;
      level1.position.leftCols(level1.node_count()) = AverageOverMembers(twin, 1, particles);
    }
    const Points start = StartOf(twin);
    const Lift lift(twin, 1, start);
    Random random(3);
    Points nodes = AverageOverMembers(twin, 1, start);
    nodes += random.Box(static_cast<int>(nodes.cols()), 0.005);
    const Points bar = random.Box(static_cast<int>(start.cols()), 1);
    const Points nodes_bar = lift.Adjoint(nodes, bar);
    std::vector<CheckedVariable> variables;
    for (Eigen::Index k = 0; k < nodes.size(); ++k) {
      variables.push_back({std::to_string(k), &nodes.data()[k], 1e-5, nodes_bar.data()[k]});
    }
    const auto loss = [&] { return lift.Apply(nodes).cwiseProduct(bar).cast<long double>().sum(); };
    const GradientReport report = CheckGradient(loss, variables);
    EXPECT_TRUE(report.passed) << report.log;
  }
}

}  // namespace
}  // namespace physpring
