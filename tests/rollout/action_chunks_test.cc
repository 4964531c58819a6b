// SPDX-License-Identifier: Apache-2.0
// Which action of which chunk is taken when.
#include "rollout/policies/action_chunks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace physpring {
namespace {

Eigen::MatrixXd Chunk(double from, int actions) {
  return Eigen::RowVectorXd::LinSpaced(actions, from, from + actions - 1);
}

TEST(ActionChunks, AllActionsAreTakenInTurn) {
  ActionChunks chunks({});
  EXPECT_TRUE(chunks.empty());
  chunks.Add(Chunk(5, 3));
  for (const double action : {5, 6, 7}) {
    ASSERT_FALSE(chunks.empty());
    EXPECT_EQ(chunks.Next()[0], action);
  }
  EXPECT_TRUE(chunks.empty());
}

TEST(ActionChunks, OnlySoManyAreExecuted) {
  ActionChunks chunks({.execute = 2});
  chunks.Add(Chunk(5, 3));
  chunks.Next();
  EXPECT_EQ(chunks.Next()[0], 6);
  EXPECT_TRUE(chunks.empty());
  chunks.Add(Chunk(1, 1));  // a chunk may be shorter
  EXPECT_EQ(chunks.Next()[0], 1);
  EXPECT_TRUE(chunks.empty());
}

// ACT's temporal ensembling: what all chunks say of a moment, the oldest with weight 1.
TEST(ActionChunks, EnsemblingIsAMeanWithTheOldestFirst) {
  constexpr double kM = 0.3;
  ActionChunks chunks({.ensemble = kM});
  chunks.Add(Chunk(10, 3));
  EXPECT_EQ(chunks.Next()[0], 10);
  EXPECT_TRUE(chunks.empty());  // asked for before each action
  chunks.Add(Chunk(20, 3));
  EXPECT_NEAR(chunks.Next()[0], (11 + std::exp(-kM) * 20) / (1 + std::exp(-kM)), 1e-12);
  chunks.Add(Chunk(30, 3));
  const double w1 = std::exp(-kM), w2 = std::exp(-2 * kM);
  EXPECT_NEAR(chunks.Next()[0], (12 + w1 * 21 + w2 * 30) / (1 + w1 + w2), 1e-12);
  chunks.Add(Chunk(40, 3));  // the first chunk is used up, the second is the oldest now
  EXPECT_NEAR(chunks.Next()[0], (22 + w1 * 31 + w2 * 40) / (1 + w1 + w2), 1e-12);
}

TEST(ActionChunks, ResetForgets) {
  ActionChunks chunks({});
  chunks.Add(Chunk(5, 3));
  chunks.Reset();
  EXPECT_TRUE(chunks.empty());
}

}  // namespace
}  // namespace physpring
