// SPDX-License-Identifier: Apache-2.0
#include "trainer/level_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/small_twin.h"
#include "trainer/network/graph_network.h"

namespace physpring {
namespace {

// A projection may be stiffer against its masses than level 0 is.
TEST(LevelFit, SoftensAProjectionThatNeedsMoreSubstepsThanLevel0) {
  Twin twin = SmallTwin(2);
  FitData data;
  Recording recording = RecordingOfMotion(twin, 8);
  recording.train_frames = 8;
  data.recordings.push_back(recording);
  data.continuous_recording = {0};
  TrainOptions options;
  options.network.latent = 4;
  options.network.epochs = 0;
  SpringMassSystem& level = twin.levels[1].system;
  level.stiffness *= 30;
  const GraphNetwork network(options.network.latent, 1);
  LevelFit fit(data, options, twin, network, network.first_weights());
  EXPECT_LE(fit.SubstepsPerSecond(), twin.levels[0].substeps_per_second);
  ASSERT_TRUE(fit.Step(1));
  EXPECT_TRUE(std::isfinite(fit.mean_square()));
}

}  // namespace
}  // namespace physpring
