// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/candidates.h"

#include <gtest/gtest.h>

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

// Branches would need a twist each; nets do not predict.
TEST(Candidates, OfARodWithBranchesAreOneChainWithoutTwist) {
  Recording rod = Rod();
  RodEdges edges = rod.rod.edges;
  std::swap(edges.back()[0], edges.front()[0]);
  edges.push_back({3, 9});
  rod.rod = RodOfEdges(edges, rod.rest);
  ASSERT_GT(RodJoints(rod.rod), 0);
  ASSERT_EQ(CandidateBodies(rod, {}).size(), 1U);
  const Body chain = CandidateBodies(rod, {})[0];
  const SpringMassSystem system = StartSystem(rod, chain, 8);
  EXPECT_EQ(system.effects.size(), 4U);
  EXPECT_NO_THROW(system.Validate("chain"));
  EXPECT_EQ(CommonFactors(system, rod, *chain.kind).effect_count(), 1 + 2 + 16);
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
  effects.AddForces({0, 1e-4, system.position, v}, &internal, &force);
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
