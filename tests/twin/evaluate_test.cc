// SPDX-License-Identifier: Apache-2.0
#include "twin/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/small_twin.h"

namespace physpring {
namespace {

TEST(Evaluate, FindsNoErrorInItsOwnMotion) {
  const Twin twin = SmallTwin(3);
  const RecordingResult result = Evaluate(twin, RecordingOfMotion(twin, 20), {});
  ASSERT_EQ(result.levels.size(), 3u);
  EXPECT_EQ(result.levels[0].direct.track[19], 0);
  EXPECT_EQ(result.levels[0].lifted.cd[19], 0);
  EXPECT_GT(result.baselines[0].errors.track[19], 0.01);
  EXPECT_GT(result.levels[0].frames_per_second, 0);
  EXPECT_EQ(result.levels[0].published_l1.value(), 0);
  EXPECT_GT(result.baselines[0].published_l1.value(), 0);
}

TEST(Evaluate, LiftsCoarseLevels) {
  const Twin twin = SmallTwin(3);
  const Recording recording = RecordingOfMotion(twin, 20);
  const RecordingResult result = Evaluate(twin, recording, {});
  for (int level : {1, 2}) {
    const LevelResult& coarse = result.levels[level];
    EXPECT_EQ(coarse.nodes, level == 1 ? 20 : 10);
    ASSERT_EQ(coarse.points.size(), 20u);
    EXPECT_EQ(coarse.points[7].cols(), recording.point_count());
    // at the start lifting is exact, while the nodes themselves are off by half a cluster
    EXPECT_LT(coarse.lifted.track[0], 1e-15);
    EXPECT_GT(coarse.direct.track[0], 0.005);
    EXPECT_LT(coarse.lifted.track[19], coarse.direct.track[19]);
  }
}

TEST(Evaluate, SplitsOnlyWhatTheTwinWasTrainedOn) {
  Twin twin = SmallTwin(1);
  Recording recording = RecordingOfMotion(twin, 20);
  recording.hash = "0123456789abcdef";
  EXPECT_EQ(Evaluate(twin, recording, {}).first_predicted, 1);
  EXPECT_FALSE(Evaluate(twin, recording, {}).trained_on);
  twin.trained_on.push_back({"swing", recording.hash, 14});
  EXPECT_EQ(Evaluate(twin, recording, {}).first_predicted, 14);
  EXPECT_TRUE(Evaluate(twin, recording, {}).trained_on);
}

}  // namespace
}  // namespace physpring
