// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/residual_correlation.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

// A rope, and a recording of what it does.
struct Moved {
  Recording recording = SwungRope(12, 120);
  SpringMassSystem system =
      MakeStartSystem(recording, {.max_neighbours = 6, .controller_max_neighbours = 6});

  Moved() {
    ScaleToSubsteps(1 / recording.fps, 12, 0.7, &system);
    MoveAs(system, true, &recording);
  }
  double Correlation() const {
    return ResidualCorrelation(system, {{&recording, recording.frame_count()}}, {});
  }
};

TEST(ResidualCorrelation, OfNoiseIsNone) {
  Moved moved;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1e-3);
  for (Points& frame : moved.recording.points) {
    for (double& value : frame.reshaped()) value += noise(random);
  }
  // a standard deviation of 1 / sqrt(3 x 12 x 119)
  EXPECT_NEAR(moved.Correlation(), 0, 4 * 0.0153);
}

TEST(ResidualCorrelation, OfAWrongBodyIsNearlyOne) {
  Moved moved;
  moved.system.stiffness *= 0.5;
  EXPECT_GT(moved.Correlation(), 0.8);
}

TEST(ResidualCorrelation, IsTheShareThatIsNoNoise) {
  Moved moved;
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 1e-3);
  for (Points& frame : moved.recording.points) {
    for (double& value : frame.reshaped()) value += 1e-3 + noise(random);
  }
  EXPECT_NEAR(moved.Correlation(), 0.5, 0.05);
}

// Noise of measurements that hardly count does not hide a wrong body.
TEST(ResidualCorrelation, IsOfWhatCounts) {
  Moved moved;
  moved.system.stiffness *= 0.5;
  const double wrong = moved.Correlation();
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.5);
  for (Points& frame : moved.recording.points) {
    for (double& value : frame.leftCols(4).reshaped()) value += noise(random);
  }
  EXPECT_LT(moved.Correlation(), 0.5 * wrong);
  Eigen::MatrixXd weight = Eigen::MatrixXd::Ones(1, 12);
  weight.leftCols(4).setConstant(1e-6);
  moved.recording.weight.assign(moved.recording.points.size(), weight);
  EXPECT_GT(moved.Correlation(), 0.95 * wrong);
  const auto frames = moved.recording.frame_count();
  const Episode episode{&moved.recording, frames};
  std::vector<Points> particles = moved.recording.points;
  for (Points& frame : particles) {
    frame.leftCols(4).row(0).array() += 1;  // m
    frame.rightCols(8).row(1).array() += 1e-3;
  }
  EXPECT_NEAR(MeanTrackError(episode, FrameUse::kFit, particles), 1e-3, 2e-6);
}

TEST(ResidualCorrelation, LeavesOutWhatIsNotSeen) {
  Moved moved;
  for (std::size_t frame = 1; frame < moved.recording.points.size(); frame += 2) {
    moved.recording.points[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(moved.Correlation(), 1);  // no point is seen in two frames in a row
}

TEST(ResidualCorrelation, OfADivergingMotionIsOne) {
  Moved moved;
  RolloutOptions options;
  options.substeps = 1;
  EXPECT_EQ(ResidualCorrelation(moved.system, {{&moved.recording, moved.recording.frame_count()}},
                                options),
            1);
}

}  // namespace
}  // namespace physpring
