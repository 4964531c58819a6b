// SPDX-License-Identifier: Apache-2.0
// A body that follows clouds is made as stiff as the object needs, and no stiffer.
#include "registration/followed_body.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "twin/stability.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr int kParticles = 60, kFrames = 150, kEvery = 5;  // of the frames, a camera sees one

// Clouds of where the recording's points are, in another order in each frame.
Recording CloudsOf(const Recording& truth) {
  Recording clouds = truth;
  std::mt19937_64 generator(2);
  for (const Points& frame : truth.points) {
    Points cloud(3, frame.cols());
    for (Eigen::Index i = 0; i < frame.cols(); ++i) {
      cloud.col(i) = frame.col((7 * i + 3) % frame.cols());
    }
    for (double& x : cloud.reshaped()) x += 1e-3 * Normal(&generator);
    clouds.surface.push_back(cloud);
  }
  return clouds;
}

double OffTruth(const Recording& truth) {
  const std::vector<Points> position =
      FollowClouds(AtRestInFrame0(CloudsOf(truth), truth.points[0]));
  double sum = 0;
  for (std::size_t t = 1; t < position.size(); ++t) {
    sum += (position[t] - truth.points[t]).colwise().norm().mean();
  }
  return sum / static_cast<double>(position.size() - 1);
}

// At ten frames a second, a body that 40 sub-steps bear would become a fifth longer.
TEST(FollowClouds, DoesNotSagWhereFramesAreFew) {
  const Recording fast = [] {
    Recording rope = SwungRope(kParticles, kFrames);
    SpringMassSystem system = MakeStartSystem(rope, {});
    ScaleToSubsteps(1 / rope.fps, 100, kStepSafety, &system);
    MoveAs(system, true, &rope);
    return rope;
  }();
  Recording slow = fast;
  slow.fps = fast.fps / kEvery;
  slow.points.clear();
  slow.controllers.clear();
  for (std::size_t t = 0; t < kFrames; t += kEvery) {
    slow.points.push_back(fast.points[t]);
    slow.controllers.push_back(fast.controllers[t]);
  }
  EXPECT_LT(OffTruth(slow), 0.01);
}

// A band that its hands pull to 1.3 times its length: no stiffer body would be shorter.
TEST(FollowClouds, StretchesWithTheObject) {
  Recording band = SwungRope(kParticles, 60);
  const Points start = band.points[0];
  const Points hand = band.controllers[0];
  for (std::size_t t = 0; t < band.points.size(); ++t) {
    const double longer = 1 + 0.15 * (1 - std::cos(0.1 * static_cast<double>(t)));
    band.points[t] = ((start.colwise() - hand.col(0)) * longer).colwise() + hand.col(0);
    Points hands(3, 2);
    hands << hand.col(0), hand.col(0) + 1.02 * (band.points[t].col(kParticles - 1) - hand.col(0));
    band.controllers[t] = hands;
  }
  EXPECT_LT(OffTruth(band), 5e-3);
}

TEST(FollowClouds, DoesNotDependOnTheThreads) {
  const Recording rope = SwungRope(12, 20);
  const Recording clouds = AtRestInFrame0(CloudsOf(rope), rope.points[0]);
  EXPECT_EQ(FollowClouds(clouds, 1), FollowClouds(clouds, 3));
}

}  // namespace
}  // namespace physpring
