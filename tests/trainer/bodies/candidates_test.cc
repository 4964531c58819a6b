// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/factors.h"
#include "twin/effects/effect_set.h"

namespace physpring {
namespace {

Recording Rod() {
  Recording recording = SwungRope(30, 2);
  recording.rod = PlainRod(Eigen::VectorXd::LinSpaced(recording.rest.cols(), 0.3, 0));
  return recording;
}

TEST(Candidates, OfARodEndWithAChainThatBends) {
  const Body chain = CandidateBodies(Rod(), {}).back();
  EXPECT_EQ(chain.neighbours, 2);
  EXPECT_FALSE(chain.kind->has_single_springs());
  const SpringMassSystem system = StartSystem(Rod(), chain, 8);
  EXPECT_EQ(system.effects.size(), 5U);
  EXPECT_NO_THROW(system.Validate("chain"));
  EXPECT_EQ(CommonFactors(system, Rod(), *chain.kind).effect_count(), 1 + 2 + 16 + 2);
}

// Nets do not predict.
TEST(Candidates, OfARodWithBranchesAreChainsWhoseJointsAreBracedOrBend) {
  Recording rod = Rod();
  RodEdges edges = rod.rod.edges;
  std::swap(edges.back()[0], edges.front()[0]);
  edges.push_back({3, 9});
  rod.rod = RodOfEdges(edges, rod.rest);
  ASSERT_GT(RodJoints(rod.rod), 0);
  ASSERT_EQ(CandidateBodies(rod, {}).size(), 2U);
  const Body braced = CandidateBodies(rod, {})[0], bends = CandidateBodies(rod, {})[1];
  EXPECT_NE(braced.Label(), bends.Label());
  for (const Body& chain : {braced, bends}) {
    EXPECT_FALSE(chain.kind->has_single_springs());
    const SpringMassSystem system = StartSystem(rod, chain, 8);
    EXPECT_EQ(system.effects.size(), 5U);
    EXPECT_NO_THROW(system.Validate("chain"));
    EXPECT_EQ(CommonFactors(system, rod, *chain.kind).effect_count(), 1 + 2 + 16 + 2);
    const std::array<int, 2> across{2, 4};  // the joint 3
    EXPECT_EQ(std::count(system.springs.begin(), system.springs.end(), across),
              chain.braced_joints ? 1 : 0);
  }
}

// What no hand and no joint holds at both ends is not twisted.
TEST(Candidates, OfABranchedRodWithFreeEndsHaveNoTwist) {
  Recording rod = Rod();
  RodEdges edges = rod.rod.edges;
  std::erase_if(edges, [&](const auto& edge) { return edge[1] >= rod.particle_count(); });
  edges.push_back({3, 9});
  const auto effects = [&] {
    rod.rod = RodOfEdges(edges, rod.rest);
    return StartSystem(rod, CandidateBodies(rod, {})[0], 8).effects.size();
  };
  EXPECT_EQ(effects(), 5U);  // two sections from the joint 3 to the joint 9
  std::erase(edges, std::array<int, 2>{8, 9});
  EXPECT_EQ(effects(), 4U);  // three branches from the joint 3
}

// Nodes that go to and fro across the rod, every other one the other way: its shortest wave.
TEST(Candidates, OfARodCalmItsShortestWave) {
  SpringMassSystem system = StartSystem(Rod(), CandidateBodies(Rod(), {}).back(), 8);
  std::erase_if(system.effects,
                [](const EffectValues& effect) { return effect.name != "bending_damping"; });
  ASSERT_EQ(system.effects.size(), 1U);
  system.position.topRows(2).setZero();  // straight
  const EffectSet effects(system, Eigen::Vector3d::Zero());
  Points v = Points::Zero(3, system.position.cols());
  for (Eigen::Index i = 0; i < v.cols(); ++i) v(0, i) = i % 2 == 0 ? 0.3 : -0.3;
  Points force = Points::Zero(3, v.cols());
  Eigen::VectorXd internal(0);
  effects.AddForces({0, 1e-4, system.position, v, {}}, &internal, &force);
  const int middle = 15;
  EXPECT_NEAR(force(0, middle) / (system.mass[middle] * v(0, middle)), -100, 1e-6);
}

TEST(Candidates, OfARodWhoseBendingIsKnownDoNotFitIt) {
  TrainOptions options;
  options.effects = {{"bending", Eigen::VectorXd::Constant(1, 1e-3)}};
  const Body chain = CandidateBodies(Rod(), options).back();
  EXPECT_EQ(chain.neighbours, 2);
  EXPECT_EQ(chain.effects.size(), 1U);
  EXPECT_EQ(chain.kind, &SpringNet());
}

TEST(Candidates, OfOtherBodiesDoNotBend) {
  for (const Body& candidate : CandidateBodies(SwungRope(30, 2), {})) {
    EXPECT_TRUE(candidate.kind->has_single_springs()) << candidate.Label();
  }
}

TEST(Candidates, HaveTheNeighboursThatAreAskedFor) {
  TrainOptions options;
  options.neighbours = {6};
  for (const Body& candidate : CandidateBodies(Rod(), options)) {
    EXPECT_EQ(candidate.neighbours, 6);
    EXPECT_EQ(candidate.kind, &SpringNet());
  }
}

}  // namespace
}  // namespace physpring
