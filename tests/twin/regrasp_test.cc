// SPDX-License-Identifier: Apache-2.0
#include "twin/regrasp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/small_twin.h"
#include "twin/hierarchy.h"
#include "twin/predict.h"

namespace physpring {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A block of 5 x 4 x 2 particles, 20 mm apart, held by 2 controllers.
class RegraspTest : public testing::Test {
 protected:
  Eigen::Block<Points, 3, 1> Hand(int controller) {
    return recording_.start.block<3, 1>(0, recording_.particle_count() + controller);
  }
  // The nodes that a controller's springs join.
  static std::set<int> HeldBy(const SpringMassSystem& system, int controller) {
    std::set<int> nodes;
    for (const auto& [a, b] : system.springs) {
      if (std::max(a, b) == system.node_count() + controller) nodes.insert(std::min(a, b));
    }
    return nodes;
  }
  static std::multiset<double> StiffnessOf(const SpringMassSystem& system) {
    return {system.stiffness.begin(), system.stiffness.end()};
  }

  const Twin twin_ = SmallTwin(2);
  Recording recording_ = RecordingOfMotion(twin_, 4);
};

TEST_F(RegraspTest, ABodyThatStartsElsewhereIsHeldAsBefore) {
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()));
  recording_.start = (turn * recording_.start).colwise() + Eigen::Vector3d(1, 0, -1);
  EXPECT_TRUE(FindMovedGrasps(twin_.levels[0].system.position, recording_).empty());
  const Twin held = HeldAsIn(&recording_, twin_);
  EXPECT_EQ(held.levels[0].system, twin_.levels[0].system);
  EXPECT_TRUE(recording_.notes.empty());
}

TEST_F(RegraspTest, SpringsGoToTheNodesNearTheHand) {
  const Eigen::Vector3d there = Hand(0) + Eigen::Vector3d(0.04, 0, 0);
  Hand(0) = there;
  const auto moved = FindMovedGrasps(twin_.levels[0].system.position, recording_);
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].controller, 0);
  EXPECT_NEAR(moved[0].distance, 0.04, 1e-9);
  EXPECT_LT((moved[0].place - there).norm(), 1e-9);
  const Twin held = HeldAsIn(&recording_, twin_);
  EXPECT_THAT(recording_.notes,
              ElementsAre(HasSubstr("controller 0 holds the object 0.04 m from")));
  for (std::size_t n = 0; n < twin_.levels.size(); ++n) {
    const SpringMassSystem &before = twin_.levels[n].system, &after = held.levels[n].system;
    after.Validate("held");
    EXPECT_EQ(StiffnessOf(after), StiffnessOf(before));
    EXPECT_EQ(HeldBy(after, 1), HeldBy(before, 1));
    EXPECT_EQ(HeldBy(after, 0).size(), HeldBy(before, 0).size());
    const Points nodes = after.position.leftCols(after.node_count());
    double furthest_held = 0, nearest_free = 1;
    for (int i = 0; i < nodes.cols(); ++i) {
      const double distance = (nodes.col(i) - there).norm();
      if (HeldBy(after, 0).contains(i)) {
        furthest_held = std::max(furthest_held, distance);
      } else {
        nearest_free = std::min(nearest_free, distance);
      }
    }
    EXPECT_LE(furthest_held, nearest_free + 1e-12);
    for (int e = 0; e < after.spring_count(); ++e) {
      const auto [a, b] = after.springs[e];
      if (std::max(a, b) != after.node_count()) continue;
      const double length = (after.position.col(a) - after.position.col(b)).norm();
      EXPECT_NEAR(after.rest_length[e], length, 1e-12);
    }
  }
}

// In the training both held throughout; here one lets go, and must not bend the rod from then on.
TEST_F(RegraspTest, AControllerThatLetsGoIsNoPartOfARod) {
  Twin rod = twin_;
  const int nodes = rod.levels[0].system.node_count();
  rod.rod = PlainRod(Eigen::VectorXd::LinSpaced(nodes + 2, 0, 1));
  SpreadRod(&rod);
  recording_.held.setConstant(recording_.frame_count(), 2, true);
  EXPECT_EQ(HeldAsIn(&recording_, rod).rod, rod.rod);
  recording_.held(recording_.frame_count() - 1, 1) = false;
  const Twin held = HeldAsIn(&recording_, rod);
  EXPECT_EQ(RodParts(held.rod)[nodes], 0);
  EXPECT_EQ(RodParts(held.rod)[nodes + 1], -1);
  EXPECT_EQ(held.levels[0].system.rod, held.rod);
}

TEST_F(RegraspTest, WhatItWasTrainedOnIsAsItWas) {
  Hand(0) += Eigen::Vector3d(0.04, 0, 0);
  recording_.hash = "0123456789abcdef";
  Twin twin = twin_;
  twin.trained_on = {{"block", recording_.hash, 4}};
  EXPECT_EQ(HeldAsIn(&recording_, twin).levels[0].system, twin.levels[0].system);
}

}  // namespace
}  // namespace physpring
