// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/last_fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr int kFrames = 70;  // 45 to 59 are held out

EffectValues Tilt(double x, double y) { return {"gravity_direction", Eigen::Vector2d(x, y)}; }

// A rope swung by one end, whose gravity tilts by another angle in the frames that are held out.
Recording TiltedRope(double tilt, double tilt_where_held) {
  Recording recording = SwungRope(6, kFrames);
  recording.train_frames = kFrames;
  SpringMassSystem system = MakeStartSystem(recording, {});
  system.effects = {Tilt(tilt, 0)};
  Recording other = recording;
  MoveAs(system, true, &recording);
  system.effects = {Tilt(tilt_where_held, 0)};
  MoveAs(system, true, &other);
  const SplitRecording split = HoldOutFrames(recording);
  for (std::size_t frame = 0; frame < split.use.size(); ++frame) {
    if (split.use[frame] == Use::kHeld) recording.points[frame] = other.points[frame];
  }
  return recording;
}

// The last fit of a rope with these effects, the last of which is not the body's own.
std::optional<Verdict> LastFit(const Recording& recording, const std::vector<EffectValues>& effects,
                               bool trusted) {
  DiagnosisBody body{MakeStartSystem(recording, {}), true,
                     trusted ? DiagnosisBody::Kind::kTrusted : DiagnosisBody::Kind::kOpen, "rope"};
  Verdict chosen;
  chosen.system = body.base;
  chosen.system.effects = effects;
  body.base.effects.assign(effects.begin(), effects.end() - 1);
  const Fitting fitting({body}, {HoldOutFrames(recording)}, 1);
  return FitAllFrames(fitting, {}, chosen);
}

TEST(FitAllFrames, FindsTheValuesFromNearby) {
  for (const bool trusted : {true, false}) {
    const auto last = LastFit(TiltedRope(0.1, 0.1), {Tilt(0.08, 0.01)}, trusted);
    ASSERT_TRUE(last);
    ASSERT_EQ(last->system.effects.size(), 1U);
    EXPECT_NEAR(last->system.effects[0].values[0], 0.1, 1e-3);
    EXPECT_NEAR(last->system.effects[0].values[1], 0, 1e-3);
    EXPECT_LT(last->track.fit, 1e-4);
  }
}

TEST(FitAllFrames, SeesTheFramesThatWereHeldOut) {
  const auto last = LastFit(TiltedRope(0.1, 0.14), {Tilt(0.1, 0)}, true);
  ASSERT_TRUE(last);
  EXPECT_GT(last->system.effects[0].values[0], 0.102);
  EXPECT_LT(last->system.effects[0].values[0], 0.13);
}

TEST(FitAllFrames, LeavesTheBodysOwnEffects) {
  const EffectValues own{"uniform_force", Eigen::VectorXd::Zero(37)};
  const auto last = LastFit(TiltedRope(0.1, 0.1), {own, Tilt(0.08, 0)}, true);
  ASSERT_TRUE(last);
  ASSERT_EQ(last->system.effects.size(), 2U);
  EXPECT_EQ(last->system.effects[0].values, own.values);
  EXPECT_NEAR(last->system.effects[1].values[0], 0.1, 1e-3);
}

TEST(FitAllFrames, SaysWhenTheMotionDiverges) {
  const Recording recording = TiltedRope(0.1, 0.1);
  DiagnosisBody body{MakeStartSystem(recording, {}), true, DiagnosisBody::Kind::kOpen, "rope"};
  Verdict chosen;
  chosen.system = body.base;
  chosen.system.stiffness *= std::numeric_limits<double>::infinity();
  chosen.system.effects = {Tilt(0.1, 0)};
  const Fitting fitting({body}, {HoldOutFrames(recording)}, 1);
  EXPECT_FALSE(FitAllFrames(fitting, {}, chosen));
}

}  // namespace
}  // namespace physpring
