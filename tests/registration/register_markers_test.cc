// SPDX-License-Identifier: Apache-2.0
// Markers on a rod that is swung, whose points come in another order in each frame.
#include "registration/register_markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "registration/rod_order.h"
#include "tests/support/file_damage.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

using testing::HasSubstr;

constexpr int kMarkers = 9, kFrames = 120;
constexpr double kSpacing = 0.1;  // m

// A rod that bends and swings between two hands at its ends.
Recording SwungRod() {
  Recording rod;
  rod.name = "rod";
  rod.fps = 100;
  rod.train_frames = kFrames;
  for (int t = 0; t < kFrames; ++t) {
    Points all(3, kMarkers + 2);
    Eigen::Vector3d at(0.2 * std::sin(0.05 * t), 0.1 * std::sin(0.03 * t), 1);
    for (int i = 0; i < all.cols(); ++i) {
      all.col(i) = at;
      const double angle = 0.3 * i * std::sin(0.04 * t + 0.5) + 0.02 * t;
      at += kSpacing * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    }
    rod.points.emplace_back(all.middleCols(1, kMarkers));
    Points& hands = rod.controllers.emplace_back(3, 2);
    hands << all.col(0), all.col(kMarkers + 1);
  }
  rod.start.resize(3, kMarkers + 2);
  rod.start << rod.points[0], rod.controllers[0];
  return rod;
}

// In any order; some are missing, some false.
Recording Shuffled(const Recording& truth, int seed) {
  Recording clouds = truth;
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  clouds.points.assign(kFrames, Points(3, 0));
  clouds.start = truth.start.rightCols(2);
  clouds.surface.clear();
  for (int t = 0; t < kFrames; ++t) {
    Points frame = truth.points[t];
    for (int i = kMarkers - 1; i > 0; --i) {
      frame.col(i).swap(frame.col(static_cast<int>(Uniform(&random) * (i + 1))));
    }
    for (int i = 0; i < kMarkers; ++i) {
      const double chance = Uniform(&random);
      if (chance < 0.1) frame.col(i).setConstant(std::nan(""));
      if (chance > 0.99) frame.col(i) += Eigen::Vector3d(0.1, -0.05, 0.08);
    }
    clouds.surface.push_back(frame);
  }
  return clouds;
}

TEST(RegisterMarkers, NamesThemAllAlongTheRod) {
  const Recording truth = SwungRod();
  for (int seed : {1, 2, 3}) {
    const RegisteredMarkers registered = RegisterMarkers(Shuffled(truth, seed), true);
    const Recording& recording = registered.recording;
    EXPECT_FALSE(registered.lost_from.has_value());
    EXPECT_LT(registered.confused, 0.03);
    ASSERT_EQ(recording.point_count(), kMarkers);
    int seen = 0;
    for (int t = 1; t < kFrames; ++t) {
      for (int i = 0; i < kMarkers; ++i) {
        const double distance = (recording.points[t].col(i) - truth.points[t].col(i)).norm();
        if (!std::isfinite(distance)) continue;
        ++seen;
        EXPECT_LT(distance, 0.3 * kSpacing) << seed << " " << t << " " << i;
      }
    }
    EXPECT_GT(seen, 0.85 * kMarkers * kFrames);
    EXPECT_NEAR(registered.seen, seen / (kMarkers * (kFrames - 1.0)), 1e-12);
    ASSERT_EQ(recording.rod.arc.size(), kMarkers + 2);
    EXPECT_NEAR(recording.rod.arc[kMarkers], 0, 1e-9);  // the first hand
    for (int i = 0; i < kMarkers; ++i) EXPECT_NEAR(recording.rod.arc[i], kSpacing * (i + 1), 5e-3);
    EXPECT_NEAR(recording.rod.arc[kMarkers + 1], kSpacing * (kMarkers + 1), 5e-3);
  }
}

// All at once further than half the distance between markers.
TEST(RegisterMarkers, TellsOfAJump) {
  Recording jump = SwungRod();
  for (int t = kFrames / 2; t < kFrames; ++t) {
    jump.points[t].row(2).array() += 2 * kSpacing;
    jump.controllers[t].row(2).array() += 2 * kSpacing;
  }
  const RegisteredMarkers registered = RegisterMarkers(Shuffled(jump, 1), true);
  EXPECT_EQ(registered.lost_from, kFrames / 2);
  jump = SwungRod();
  for (int t = kFrames / 2; t < kFrames; ++t) {  // each to where another one was
    for (int i = kMarkers - 1; i >= 2; --i) jump.points[t].col(i) = jump.points[t].col(i - 2);
    jump.points[t].leftCols(2).row(2).array() += 3 * kSpacing;
  }
  EXPECT_GT(RegisterMarkers(Shuffled(jump, 1), false).confused, 0.05);
}

TEST(RegisterMarkers, TakesUpAfterAGap) {
  Recording clouds = Shuffled(SwungRod(), 1);
  for (int t = 50; t < 54; ++t) clouds.surface[t].setConstant(std::nan(""));
  const RegisteredMarkers registered = RegisterMarkers(clouds, true);
  EXPECT_FALSE(registered.lost_from.has_value());
  EXPECT_EQ(registered.recording.point_count(), kMarkers);
}

TEST(RegisterMarkers, RefusesTooFew) {
  Recording clouds = Shuffled(SwungRod(), 1);
  clouds.surface[0].rightCols(kMarkers - 3).setConstant(std::nan(""));
  EXPECT_THAT(ErrorOf("recording rod", [&] { RegisterMarkers(clouds, false); }),
              HasSubstr("points in frame 0, expected 4 or more"));
}

TEST(RodOrder, RefusesBranches) {
  Points star = Points::Zero(3, 4);
  star.rightCols(3) = Eigen::Matrix3d::Identity();
  EXPECT_EQ(ErrorOf("recording star", [&] { RodOrder({star}, "recording star"); }),
            "recording star: is no rod: 3 others are next to the one that starts at (0, 0, 0) m");
  Points apart = star;
  apart.col(1).setConstant(std::nan(""));
  EXPECT_THAT(ErrorOf("recording star", [&] { RodOrder({apart}, "recording star"); }),
              HasSubstr("two of its points are never seen together"));
}

}  // namespace
}  // namespace physpring
