// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/level_model.h"

#include <gtest/gtest.h>

#include "tests/support/small_twin.h"
#include "trainer/network/graph_network.h"

namespace physpring {
namespace {

// A projection may be stiffer against its masses than level 0 is.
TEST(LevelModel, SoftensAProjectionThatNeedsMoreSubstepsThanLevel0) {
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
  const LevelModel model(data, options, twin, network);
  const SpringMassSystem& softened = model.twin().levels[1].system;
  EXPECT_LT(softened.stiffness.maxCoeff(), level.stiffness.maxCoeff());
  EXPECT_LE(model.LevelOf(softened).substeps_per_second, twin.levels[0].substeps_per_second);
  const LiftedMotion motion = model.Motion(1, 0, 1);
  EXPECT_TRUE(motion.Run(softened, motion.SubstepsOf(softened)).has_value());
}

}  // namespace
}  // namespace physpring
