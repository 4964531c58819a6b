// SPDX-License-Identifier: Apache-2.0
#include "cli/training_hint.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

constexpr double kHours = 3600;

TEST(TrainingHint, IsForLongTrainingsOnly) {
  EXPECT_EQ(HintIfLong({}, 60, 1700), "");
  EXPECT_NE(HintIfLong({}, 60, 1900), "");
}

TEST(TrainingHint, WaitsUntilThePaceIsKnown) {
  EXPECT_EQ(HintIfLong({}, 10, 6 * kHours), "");
  EXPECT_EQ(HintIfLong({}, 60, -1), "");
}

TEST(TrainingHint, NamesOptionsThatAreNotGiven) {
  EXPECT_EQ(HintIfLong({}, 60, 6 * kHours),
            "note: 6 h 0 min left; each of these makes it shorter: --neighbours 20, "
            "--controller-velocity off, --cone elliptic, --precision float, fewer "
            "points, fewer frames (Ctrl-C leaves a checkpoint)");
  TrainOptions options;
  options.method = TrainOptions::Method::kTwoStage;
  options.single_precision = true;
  EXPECT_EQ(HintIfLong(options, 60, 6 * kHours),
            "note: 6 h 0 min left; each of these makes it shorter: a small --epochs, fewer points, "
            "fewer frames "
            "(Ctrl-C leaves a checkpoint)");
}

}  // namespace
}  // namespace physpring
