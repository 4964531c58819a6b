// SPDX-License-Identifier: Apache-2.0
// A swung rope of which a part is seen, and twins that are right or wrong.
#include "tracker/track_recording.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/swung_rope.h"
#include "tracker/tracker_bank.h"
#include "trainer/bodies/start_system.h"
#include "twin/error.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr int kParticles = 12, kFrames = 120;
constexpr double kNoise = 5e-4;            // m
constexpr double kOfNoise = 1.6 * kNoise;  // the mean distance that it makes of a point, about

class TrackedRope : public testing::Test {
 protected:
  TrackedRope() : recording_(SwungRope(kParticles, kFrames)) {
    system_ = MakeStartSystem(recording_, {});
    MoveAs(system_, true, &recording_);
    truth_ = recording_.points;
    std::mt19937_64 generator(3);
    for (Points& frame : recording_.points) {
      if (&frame == &recording_.points[0]) continue;
      for (double& x : frame.reshaped()) x += kNoise * Normal(&generator);
    }
  }

  Twin TwinOf(const SpringMassSystem& system) const {
    Twin twin;
    twin.levels.push_back({system, {}, 1});
    twin.points = kParticles;
    twin.fps = recording_.fps;
    return twin;
  }
  // One that moves otherwise.
  SpringMassSystem Wrong() const {
    SpringMassSystem wrong = system_;
    wrong.mass.tail(3) *= 6;
    wrong.drag = 3;
    return wrong;
  }
  // The mean distance from the truth.
  double OffTruth(const TrackedMotion& motion) const {
    double sum = 0;
    for (int t = 1; t < kFrames; ++t) {
      sum += (motion.position[t] - truth_[t]).colwise().norm().mean() / (kFrames - 1);
    }
    return sum;
  }
  // Clouds of two thirds of the points, in another order in each frame.
  void MakeClouds() {
    std::mt19937_64 generator(5);
    for (const Points& frame : recording_.points) {
      std::vector<int> order(kParticles);
      for (int i = 0; i < kParticles; ++i) order[i] = i;
      for (int i = kParticles; i > 1; --i) std::swap(order[i - 1], order[generator() % i]);
      order.resize(2 * kParticles / 3);
      recording_.surface.emplace_back(frame(Eigen::all, order));
    }
  }

  Recording recording_;
  SpringMassSystem system_;
  std::vector<Points> truth_;
};

TEST_F(TrackedRope, CountsMeasurementsByTheirWeights) {
  std::mt19937_64 generator(9);
  recording_.weight.assign(kFrames, Eigen::MatrixXd::Ones(1, kParticles));
  for (int t = 1; t < kFrames; ++t) {
    for (int i = t % 3; i < kParticles; i += 3) {  // a third is poor
      for (int j = 0; j < 3; ++j) recording_.points[t](j, i) += 20 * kNoise * Normal(&generator);
      recording_.weight[t](0, i) = 1 / 400.0;
    }
  }
  const Twin twin = TwinOf(Wrong());
  const double weighted = OffTruth(TrackRecording(twin, recording_, {}));
  recording_.weight.clear();
  EXPECT_LT(weighted, 0.6 * OffTruth(TrackRecording(twin, recording_, {})));
}

TEST_F(TrackedRope, TrustsARightTwin) {
  const TrackedMotion motion = TrackRecording(TwinOf(system_), recording_, {.hide = 0.5});
  EXPECT_EQ(motion.hidden.size(), kParticles / 2);
  EXPECT_LT(OffTruth(motion), 0.5 * kOfNoise);
  EXPECT_LT(motion.errors.tracked, 1.2 * kOfNoise);
  EXPECT_NEAR(motion.errors.predicted, kOfNoise, 0.2 * kOfNoise);
}

TEST_F(TrackedRope, PullsAWrongTwinAlong) {
  const TrackedMotion motion = TrackRecording(TwinOf(Wrong()), recording_, {.hide = 0.5});
  EXPECT_GT(motion.errors.predicted, 5 * kOfNoise);
  EXPECT_LT(motion.errors.tracked, 0.3 * motion.errors.predicted);
}

TEST_F(TrackedRope, FollowsACloudWithoutNames) {
  MakeClouds();
  const TrackedMotion motion = TrackRecording(TwinOf(system_), recording_, {.cloud = true});
  EXPECT_LT(OffTruth(motion), kOfNoise);
  EXPECT_LT(motion.cloud->distance, motion.cloud->spacing);
  const TrackedMotion pulled = TrackRecording(TwinOf(Wrong()), recording_, {.cloud = true});
  EXPECT_LT(pulled.errors.tracked, 0.5 * pulled.errors.predicted);
}

TEST_F(TrackedRope, DoesNotTellWhatIsHidden) {
  const TrackOptions options{.hide = 0.5};
  const TrackedMotion motion = TrackRecording(TwinOf(Wrong()), recording_, options);
  for (Points& frame : recording_.points) {
    for (int i : motion.hidden) frame(2, i) += &frame == &recording_.points[0] ? 0 : 0.1;
  }
  const TrackedMotion again = TrackRecording(TwinOf(Wrong()), recording_, options);
  EXPECT_EQ(again.hidden, motion.hidden);
  EXPECT_EQ(again.position, motion.position);
  EXPECT_GT(again.errors.tracked, 0.09);
}

TEST_F(TrackedRope, GoesOnWhereNothingIsSeen) {
  for (int t = 40; t < 80; ++t) {
    recording_.points[t].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_LT(OffTruth(TrackRecording(TwinOf(system_), recording_, {})), kOfNoise);
}

TEST_F(TrackedRope, SaysWhereThereIsNoCloud) {
  EXPECT_THROW(TrackRecording(TwinOf(system_), recording_, {.cloud = true}), Error);
}

TEST_F(TrackedRope, SaysWhereTheTwinIsOfAnotherObject) {
  Twin twin = TwinOf(system_);
  twin.points = kParticles + 1;
  EXPECT_THROW(TrackRecording(twin, recording_, {}), Error);
}

}  // namespace
}  // namespace physpring
