// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "jobs/tracking.h"

namespace physpring {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Particles 30 mm apart.
TrackedMotion InClouds(double tracked, double predicted) {
  TrackedMotion motion;
  motion.errors = {std::nan(""), std::nan(""), std::nan("")};  // nothing judges
  motion.cloud = CloudFit{tracked, 0.03};
  motion.predicted_cloud_distance = predicted;
  return motion;
}

TEST(TrackingWarnings, TellNothingOfATwinThatPredictsTheClouds) {
  EXPECT_THAT(WarningsOf(InClouds(0.008, 0.009)), IsEmpty());
  EXPECT_THAT(WarningsOf(InClouds(0.008, std::nan(""))), IsEmpty()) << "it diverges";
}

TEST(TrackingWarnings, TellWhereTheTwinEndsElsewhere) {
  EXPECT_THAT(WarningsOf(InClouds(0.008, 0.148)),
              ElementsAre(HasSubstr("without measurements the twin ends 148 mm from the clouds")));
}

TEST(TrackingWarnings, TellWhereMeasurementsDoHarm) {
  EXPECT_THAT(WarningsOf(InClouds(0.02, 0.01)), ElementsAre(HasSubstr("is nearer to the clouds")));
  EXPECT_THAT(WarningsOf(InClouds(0.05, 0.01)),
              ElementsAre(HasSubstr("it is lost"), HasSubstr("is nearer to the clouds")));
}

}  // namespace
}  // namespace physpring
