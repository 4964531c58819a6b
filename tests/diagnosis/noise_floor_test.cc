// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/noise_floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

// Points that swing by 5 cm once a second, 50 frames a second, with normal noise.
Recording Swing(double noise) {
  Random random(1);
  const auto normal = [&] {
    return std::sqrt(-2 * std::log(1 - random(0, 1))) *
           std::cos(2 * std::numbers::pi * random(0, 1));
  };
  Recording recording;
  for (int t = 0; t < 150; ++t) {
    Points points(3, 20);
    for (double& value : points.reshaped()) {
      value = 0.05 * std::sin(2 * std::numbers::pi * t / 50) + noise * normal();
    }
    recording.points.push_back(points);
  }
  return recording;
}

TEST(NoiseFloor, IsThatOfTheMeasurements) {
  const Recording recording = Swing(7e-4);
  // 9,000 differences: the median is known to about 1 %
  EXPECT_NEAR(MeasurementNoise({&recording}), 7e-4, 0.05 * 7e-4);
}

TEST(NoiseFloor, DoesNotTakeMotionForNoise) {
  const Recording recording = Swing(0);
  EXPECT_LT(MeasurementNoise({&recording}), 2e-6);
}

TEST(NoiseFloor, LeavesUnseenPointsOut) {
  Recording recording = Swing(7e-4);
  for (std::size_t t = 0; t < recording.points.size(); t += 7) {
    recording.points[t]
        .col(static_cast<Eigen::Index>(t) % 20)
        .setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_NEAR(MeasurementNoise({&recording}), 7e-4, 0.05 * 7e-4);
}

TEST(NoiseFloor, IsUnknownWhereNoPointIsSeenInFiveFramesInARow) {
  Recording recording = Swing(7e-4);
  for (std::size_t t = 0; t < recording.points.size(); t += 4) {
    recording.points[t].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_TRUE(std::isnan(MeasurementNoise({&recording})));
}

TEST(NoiseFloor, IsTheMeanLengthOfNoise) {
  EXPECT_NEAR(TrackNoiseFloor(7e-4), 1.117e-3, 1e-6);  // 2 s sqrt(2 / pi)
}

}  // namespace
}  // namespace physpring
