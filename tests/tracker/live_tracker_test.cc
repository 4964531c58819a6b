// SPDX-License-Identifier: Apache-2.0
#include "tracker/live_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/small_twin.h"
#include "tracker/tracked_body.h"
#include "twin/effects/registry.h"
#include "twin/environment.h"
#include "twin/error.h"
#include "twin/grasps.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 20;
constexpr double kNoise = 1e-3;

class LiveTrackerTest : public testing::Test {
 protected:
  LiveTrackerTest() {
    // it is pushed, which the twin does not know, and half of it is seen
    for (int t = 0; t < kFrames; ++t) recording_.points[t].row(1).array() += 0.001 * t;
    for (int t = 1; t < kFrames; ++t) {
      for (int i = t % 2; i < recording_.point_count(); i += 2) {
        recording_.points[t].col(i).setConstant(std::nan(""));
      }
    }
  }

  LiveFrame Frame(int t) const {
    return {{recording_.points[t], Points(3, 0)}, recording_.controllers[t]};
  }

  Twin twin_ = SmallTwin(1);
  Recording recording_ = RecordingOfMotion(twin_, kFrames);
};

// The same numbers as of a bank that reads a recording, with a delay of the controllers.
TEST_F(LiveTrackerTest, DoesWhatTheBankDoesWithARecording) {
  SpringMassSystem& system = twin_.levels[0].system;
  for (double delay : {0.0, 0.05}) {
    system.effects = {{"control_latency", Eigen::VectorXd::Constant(1, delay)}};
    TrackerBank bank(system, {twin_.gravity, twin_.ground.plane},
                     {1 / recording_.fps,
                      BodyToTrack(system, recording_.fps, 0).substeps,
                      twin_.controller_velocity,
                      {}},
                     kNoise, recording_.point_count(),
                     recording_.start.leftCols(recording_.particle_count()),
                     Points::Zero(3, recording_.particle_count()));
    LiveTracker live(twin_, {recording_.fps, kNoise}, Frame(0));
    // the interior is not measured
    const Points start = live.state().position();
    EXPECT_LT((start - bank.best().position()).cwiseAbs().maxCoeff(), 1e-9);
    for (int t = 1; t < kFrames; ++t) {
      live.Advance(Frame(t));
      bank.Advance(RecordedInput(recording_, t, delay), Frame(t).measured);
      EXPECT_LT((live.state().position() - bank.best().position()).cwiseAbs().maxCoeff(), 1e-9)
          << delay << " " << t;
    }
    EXPECT_GT((live.state().position() - start).cwiseAbs().maxCoeff(), 0.01);
  }
}

// The same with a hand that opens and closes. Nobody says where it is while it is open.
TEST_F(LiveTrackerTest, LetsGoAndTakesHoldAsInARecording) {
  constexpr int kOpens = 5, kCloses = 11;
  recording_.held.setConstant(kFrames, 2, true);
  recording_.held.block(kOpens, 1, kCloses - kOpens, 1).setConstant(false);
  FindShapesWhenHeld(&recording_);
  const TrackedBody body = BodyToTrack(twin_.levels[0].system, recording_.fps, 0);
  TrackerBank bank(body.system, {twin_.gravity, twin_.ground.plane},
                   {1 / recording_.fps, body.substeps, twin_.controller_velocity, {true, true}},
                   kNoise, recording_.point_count(),
                   recording_.start.leftCols(recording_.particle_count()),
                   Points::Zero(3, recording_.particle_count()));
  LiveTracker live(twin_, {recording_.fps, kNoise}, Frame(0));
  LiveTracker holds(twin_, {recording_.fps, kNoise}, Frame(0));
  double apart = 0;
  for (int t = 1; t < kFrames; ++t) {
    const LiveFrame known = Frame(t);
    LiveFrame told = known;
    if (t == kOpens || t == kCloses) told.held = ControllerMask{true, t == kCloses};
    if (t >= kOpens && t < kCloses) told.controllers.col(1).setConstant(std::nan(""));
    live.Advance(told);
    holds.Advance(known);
    bank.Advance(RecordedInput(recording_, t, 0), known.measured);
    const Points position = live.state().position();
    EXPECT_LT((position - bank.best().position()).cwiseAbs().maxCoeff(), 1e-9) << t;
    apart = std::max(apart, (position - holds.state().position()).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(apart, 1e-3);
}

TEST_F(LiveTrackerTest, StartsWhereAPartOfItIsSeen) {
  LiveFrame first = Frame(0);
  const Points truth = recording_.points[0];
  for (int i = 0; i < truth.cols(); i += 2) first.measured.named.col(i).setConstant(std::nan(""));
  const LiveTracker live(twin_, {recording_.fps, kNoise}, first);
  EXPECT_LT((live.state().position().leftCols(truth.cols()) - truth).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(LiveTrackerTest, RefusesOtherNumbers) {
  LiveTracker live(twin_, {recording_.fps, kNoise}, Frame(0));
  const auto message = [&](const LiveFrame& frame) -> std::string {
    try {
      live.Advance(frame);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  LiveFrame frame = Frame(1);
  frame.controllers = Points(3, 0);
  EXPECT_EQ(message(frame), "has 0 controllers, expected 2");
  frame = Frame(1);
  frame.measured.named = Points::Zero(3, 5);
  EXPECT_EQ(message(frame), "has 5 points, expected 32, or none");
  frame.measured.named = Points(3, 0);
  EXPECT_EQ(message(frame), "");
}

}  // namespace
}  // namespace physpring
