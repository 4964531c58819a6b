// SPDX-License-Identifier: Apache-2.0
#include "trainer/fit_model.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"

namespace physpring {
namespace {

Recording Rod() {
  Recording recording = SwungRope(30, 2);
  recording.order = Eigen::VectorXd::LinSpaced(recording.rest.cols(), 0.3, 0);
  return recording;
}

TEST(Candidates, OfARodEndWithAChainThatBends) {
  const Candidate chain = Candidates(Rod(), {}).back();
  EXPECT_EQ(chain.neighbours, 2);
  EXPECT_EQ(chain.free_effects, 4);
  const SpringMassSystem system = StartSystem(Rod(), chain, 8);
  EXPECT_EQ(system.effects.size(), 4U);
  EXPECT_NO_THROW(system.Validate("chain"));
  EXPECT_EQ(CommonFactors(system, Rod(), 4).effect_count(), 1 + 1 + 2 + 16);
}

TEST(Candidates, OfARodWhoseBendingIsKnownDoNotFitIt) {
  TrainOptions options;
  options.effects = {{"bending", Eigen::VectorXd::Constant(1, 1e-3)}};
  const Candidate chain = Candidates(Rod(), options).back();
  EXPECT_EQ(chain.neighbours, 2);
  EXPECT_EQ(chain.effects.size(), 1U);
  EXPECT_EQ(chain.free_effects, 0);
}

TEST(Candidates, OfOtherBodiesDoNotBend) {
  for (const Candidate& candidate : Candidates(SwungRope(30, 2), {})) {
    EXPECT_EQ(candidate.free_effects, 0) << candidate.Label();
  }
}

TEST(Candidates, HaveTheNeighboursThatAreAskedFor) {
  TrainOptions options;
  options.neighbours = {6};
  for (const Candidate& candidate : Candidates(Rod(), options)) {
    EXPECT_EQ(candidate.neighbours, 6);
    EXPECT_EQ(candidate.free_effects, 0);
  }
}

}  // namespace
}  // namespace physpring
