// SPDX-License-Identifier: Apache-2.0
// A twin of a cloth, and clouds of that cloth elsewhere.
#include "registration/placed_twin.h"

#include <gtest/gtest.h>

#include "tests/support/clouded_cloth.h"
#include "tests/support/file_damage.h"
#include "tracker/track_recording.h"
#include "twin/predict.h"

namespace physpring {
namespace {

constexpr int kInterior = 9;

class PlacedTwin : public testing::Test {
 protected:
  PlacedTwin() {
    const Recording trained = SwungCloth(false);
    SpringMassSystem system = MakeStartSystem(trained, {});
    ScaleToSubsteps(1 / trained.fps, 60, kStepSafety, &system);
    twin_.levels.push_back({system, {}, 60 * 50});
    twin_.points = trained.point_count() - kInterior;
    twin_.interior = kInterior;
    twin_.name = "cloth";
    twin_.fps = trained.fps;
  }

  Recording elsewhere_ = SwungCloth(true);
  Twin twin_;
};

TEST_F(PlacedTwin, IsWhereTheObjectIsInFrame0) {
  const Recording placed = PlaceTwin(twin_, CloudsOf(elsewhere_, 2));
  ASSERT_EQ(placed.point_count(), twin_.points);
  ASSERT_EQ(placed.interior_count(), kInterior);
  ExpectSameObject(twin_, placed);
  const Points off = placed.start.leftCols(twin_.points + kInterior) - elsewhere_.points[0];
  EXPECT_LT(off.colwise().norm().mean(), 0.2 * kSpacing);
  EXPECT_EQ(placed.points[0], placed.start.leftCols(twin_.points));
  EXPECT_TRUE(placed.points[1].array().isNaN().all());
}

// At five frames a second, too, and where the first cloud shows one half, or nothing.
TEST_F(PlacedTwin, StaysWhereTheFirstCloudShowsNothing) {
  Recording clouds = CloudsOf(elsewhere_, 2);
  clouds.fps = 5;
  const auto off = [&] {
    const Points start = PlaceTwin(twin_, clouds).start.leftCols(twin_.points + kInterior);
    return (start - elsewhere_.points[0]).colwise().norm().maxCoeff();
  };
  Points& first = clouds.surface[0];
  const double middle = first.row(0).mean();
  for (auto point : first.colwise()) {
    if (point[0] > middle) point.setConstant(std::nan(""));
  }
  EXPECT_LT(off(), 0.2 * kSpacing);
  first.setConstant(std::nan(""));
  EXPECT_LT(off(), 1e-3 * kSpacing);
}

TEST_F(PlacedTwin, IsTrackedThroughClouds) {
  const Recording placed = PlaceTwin(twin_, CloudsOf(elsewhere_, 2));
  const TrackedMotion motion = TrackRecording(twin_, placed, {.cloud = true});
  double off = 0;
  for (int t = 1; t < kFrames; ++t) {
    off += (motion.position[t] - elsewhere_.points[t]).colwise().norm().mean() / (kFrames - 1);
  }
  EXPECT_LT(off, 0.2 * kSpacing);
  EXPECT_LT(motion.cloud->distance, motion.cloud->spacing);
  EXPECT_TRUE(motion.hidden.empty());  // no point was measured that could judge
}

TEST_F(PlacedTwin, NeedsItsControllers) {
  Recording clouds = CloudsOf(elsewhere_, 2);
  for (Points& hands : clouds.controllers) hands = hands.leftCols(1).eval();
  EXPECT_EQ(
      ErrorOf("recording turned", [&] { PlaceTwin(twin_, clouds); }),
      "recording turned: has 1 controllers, but cloth has 2; expected recordings of one object");
}

}  // namespace
}  // namespace physpring
