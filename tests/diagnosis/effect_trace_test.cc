// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_trace.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

constexpr int kFrames = 50;
constexpr double kGain = 0.1;

// A rope swung by one end, whose gravity is tilted sideways.
class TraceOfATiltedRope : public testing::Test {
 protected:
  TraceOfATiltedRope() : recording_(SwungRope(6, kFrames)), body_(MakeStartSystem(recording_, {})) {
    recording_.train_frames = kFrames;
    SpringMassSystem tilted = body_;
    tilted.effects = {{"gravity_direction", Eigen::Vector2d(0.1, 0.05)}};
    MoveAs(tilted, true, &recording_);
  }

  std::vector<EffectTrace> Trace(const SpringMassSystem& body, int threads) const {
    const Fitting fitting({{body, true, DiagnosisBody::Kind::kTrusted, "rope"}},
                          {UseAll(recording_, SplitRecording::Use::kFit)}, threads);
    return TraceEffects(fitting, fitting.Begin(0, {}),
                        {&GetEffect("control_latency"), &GetEffect("gravity_direction")}, kGain,
                        {});
  }

  Recording recording_;
  SpringMassSystem body_;
};

TEST_F(TraceOfATiltedRope, RanksTheTiltFirst) {
  const std::vector<EffectTrace> traces = Trace(body_, 1);
  ASSERT_EQ(traces.size(), 2U);  // in the order in which they were asked for
  EXPECT_EQ(traces[0].effect->name(), "control_latency");
  EXPECT_EQ(traces[1].effect->name(), "gravity_direction");
  // a tilt of 0.1 rad is nearly linear: one step takes almost all of it away
  EXPECT_GT(traces[1].score, 0.9);
  EXPECT_LT(traces[0].score, 0.5 * traces[1].score);
  EXPECT_EQ(traces[1].start.size(), 2);
}

TEST_F(TraceOfATiltedRope, StartsWithControllersThatAreAheadWhereTheyAre) {
  SpringMassSystem ahead = body_;
  ahead.effects = {{"control_latency", Eigen::VectorXd::Constant(1, -0.05)}};
  MoveAs(ahead, true, &recording_);
  const std::vector<EffectTrace> traces = Trace(body_, 1);
  EXPECT_GT(traces[0].score, 0.9);
  EXPECT_LT(traces[1].score, 0.5 * traces[0].score);
  ASSERT_EQ(traces[0].start.size(), 1);
  EXPECT_LT(traces[0].start[0], 0);
}

TEST_F(TraceOfATiltedRope, DoesNotHangOnTheThreads) {
  const std::vector<EffectTrace> one = Trace(body_, 1), two = Trace(body_, 2);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].score, two[i].score);
    EXPECT_EQ(one[i].start, two[i].start);
  }
}

}  // namespace
}  // namespace physpring
