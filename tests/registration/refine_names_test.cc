// SPDX-License-Identifier: Apache-2.0
// A row of points that moves along x. From a frame on, a part of its points is taken for their
// neighbours.
#include "registration/refine_names.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace physpring {
namespace {

constexpr int kPoints = 20, kFrames = 60, kFitted = 50;
constexpr double kSpacing = 0.02;  // m

// Where the row is; points swing across it, each by its own phase.
Points Row(int frame) {
  Points row(3, kPoints);
  for (int i = 0; i < kPoints; ++i) {
    row.col(i) << kSpacing * i + 1e-3 * frame, 0.01 * std::sin(0.2 * frame + 0.3 * i), 0.5;
  }
  return row;
}

std::vector<Points> Rows() {
  std::vector<Points> rows;
  for (int t = 0; t < kFrames; ++t) rows.push_back(Row(t));
  return rows;
}

// A prediction that is right until `until`, and then farther and farther off.
std::vector<Points> RightUntil(int until) {
  std::vector<Points> rows = Rows();
  for (int t = until; t < kFrames; ++t) {
    rows[static_cast<std::size_t>(t)].row(1).array() += 5e-3 * (t - until + 1);
  }
  return rows;
}

// Its clouds show each point, off by a fixed millimetre.
RegisteredClouds Registered() {
  RegisteredClouds registered;
  registered.recording.train_frames = kFitted;
  registered.recording.fps = 30;
  registered.recording.points = Rows();
  for (Points row : Rows()) {
    row.row(2).array() += 1e-3;
    registered.recording.surface.push_back(row);
  }
  registered.outliers = 3;
  return registered;
}

TEST(RefineNames, EndsWhenAllFramesAreExplained) {
  std::vector<int> fitted;
  const std::vector<int> right = {20, 35, kFrames};
  const RefinedNames refined =
      RefineNames(Registered(), [&](const Recording& recording, int round) {
        fitted.push_back(recording.train_frames);
        return RightUntil(right[static_cast<std::size_t>(round)]);
      });
  ASSERT_EQ(refined.fits, 3);
  EXPECT_EQ(refined.explained, kFitted);
  EXPECT_EQ(refined.registered.outliers, 3);
  EXPECT_EQ(refined.registered.recording.train_frames, kFitted);
  EXPECT_EQ(fitted[0], kFitted);
  EXPECT_NEAR(fitted[1], 20, 3);  // distances are averaged over a few frames
  EXPECT_NEAR(fitted[2], 35, 3);
}

// Fewer frames than tell of a body are not fitted, though fewer may be explained.
TEST(RefineNames, FitsNoFewerFramesThanTellOfABody) {
  int fitted = 0;
  const RefinedNames refined = RefineNames(Registered(), [&](const Recording& recording, int) {
    fitted = recording.train_frames;
    return RightUntil(4);
  });
  EXPECT_EQ(fitted, 12);
  EXPECT_LT(refined.explained, 7);
}

// What the clouds tell is near the prediction, and frame 0 stays as it was.
TEST(RefineNames, TellsPointsWhereTheyArePredicted) {
  RegisteredClouds wrong = Registered();
  for (std::size_t t = 1; t < kFrames; ++t) {
    Points& points = wrong.recording.points[t];
    points.leftCols(kPoints - 1) = points.rightCols(kPoints - 1).eval();
  }
  const RefinedNames refined =
      RefineNames(wrong, [](const Recording&, int) { return RightUntil(kFrames); });
  EXPECT_EQ(refined.fits, 1);
  EXPECT_EQ(refined.registered.recording.points[0], Row(0));
  for (int t = 1; t < kFrames; ++t) {
    const Points off = refined.registered.recording.points[static_cast<std::size_t>(t)] - Row(t);
    EXPECT_LT(off.colwise().norm().maxCoeff(), 2e-3) << t;
  }
}

// No fit gets on: the names are those of the best one, not of the last.
TEST(RefineNames, KeepsTheBestOfFitsThatExplainNoMore) {
  const RefinedNames refined =
      RefineNames(Registered(), [](const Recording&, int round) { return RightUntil(30 - round); });
  EXPECT_EQ(refined.fits, kMostNamingRounds);
  EXPECT_LT(refined.explained, 32);
  const auto told = [](const RegisteredClouds& clouds) { return clouds.seen; };
  const RefinedNames first =
      RefineNames(Registered(), [](const Recording&, int) { return RightUntil(30); });
  EXPECT_EQ(told(refined.registered), told(first.registered));
}

}  // namespace
}  // namespace physpring
