// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/fitting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr int kFrames = 70;  // 45 to 59 are held out

// A rope swung by one end, measured as one with a third of its stiffness would move.
Recording SofterRope() {
  Recording recording = SwungRope(6, kFrames);
  SpringMassSystem other = MakeStartSystem(recording, {});
  other.stiffness *= 0.3;
  MoveAs(other, true, &recording);
  recording.train_frames = kFrames;
  return recording;
}

Fitting FittingOf(const Recording& recording) {
  const DiagnosisBody body{MakeStartSystem(recording, {}), true, DiagnosisBody::Kind::kTrusted,
                           "rope"};
  return Fitting({body}, {HoldOutFrames(recording)}, 1);
}

Eigen::VectorXd ResidualsAt(const Recording& recording, double gain) {
  const Fitting fitting = FittingOf(recording);
  const Descent descent = fitting.Begin(0, {});
  EffectProblem problem = fitting.Problem(descent.hypothesis, gain, Fitting::Care::kRough);
  problem.FixSubsteps(descent.x);
  return *problem.Residuals(descent.x);
}

// Moves what was measured in the held-out frames.
Recording WithOtherHeldFrames(const Recording& recording) {
  Recording other = recording;
  const SplitRecording split = HoldOutFrames(recording);
  for (std::size_t frame = 1; frame < split.use.size(); ++frame) {
    if (split.use[frame] == Use::kHeld) other.points[frame].array() += 0.1;
  }
  return other;
}

TEST(Fitting, AnObserverMakesResidualsSmaller) {
  const Recording recording = SofterRope();
  EXPECT_LT(ResidualsAt(recording, 0.5).norm(), 0.5 * ResidualsAt(recording, 0).norm());
}

TEST(Fitting, AnObserverSeesNoHeldOutFrames) {
  const Recording recording = SofterRope();
  const Recording other = WithOtherHeldFrames(recording);
  ASSERT_NE(HoldOutFrames(recording).last(Use::kHeld), 0);
  EXPECT_EQ(ResidualsAt(recording, 0.5), ResidualsAt(other, 0.5));
}

TEST(Fitting, JudgesWithoutAnObserver) {
  const Recording recording = SofterRope();
  const Recording other = WithOtherHeldFrames(recording);
  const Fitting fitting = FittingOf(recording), judged = FittingOf(other);
  std::vector<Descent> descents = {fitting.Begin(0, {})};
  fitting.Descend(0.5, Fitting::Care::kRough, 2, &descents);
  ASSERT_EQ(descents.size(), 1U);
  const auto verdict = fitting.Judge(descents[0]), same = judged.Judge(descents[0]);
  ASSERT_TRUE(verdict);
  ASSERT_TRUE(same);
  EXPECT_EQ(verdict->track.fit, same->track.fit);
  EXPECT_NE(verdict->track.held, same->track.held);
}

// All springs then have one loss time, the mean one.
TEST(Fitting, ASmoothBodyBeginsWhereItsDescentIs) {
  const Recording recording = SofterRope();
  const DiagnosisBody body{MakeStartSystem(recording, {}), true, DiagnosisBody::Kind::kOpen,
                           "rope"};
  const Fitting fitting({body}, {HoldOutFrames(recording)}, 1);
  Descent descent = fitting.Begin(0, {{"gravity_direction", Eigen::Vector2d(0.1, 0)}});
  descent.x.setConstant(0.2);
  const Descent smooth = fitting.Smooth(descent, SmoothBody::Numbers::kAll);
  const SpringMassSystem before = fitting.Model(descent.hypothesis).Apply(descent.x);
  const SpringMassSystem after = fitting.Model(smooth.hypothesis).Apply(smooth.x);
  EXPECT_LT((after.stiffness - before.stiffness).norm(), 1e-12 * before.stiffness.norm());
  EXPECT_NEAR(after.dashpot.sum(), before.dashpot.sum(), 1e-12 * before.dashpot.sum());
  EXPECT_EQ(after.drag, before.drag);
  ASSERT_EQ(after.effects.size(), 1U);
  EXPECT_EQ(after.effects[0].values, before.effects[0].values);
  EXPECT_NE(KeyOf("a", smooth.hypothesis).Hash(), KeyOf("a", descent.hypothesis).Hash());
}

TEST(Fitting, ABodyThatIsTrustedMayBeAsStiffAsItCame) {
  const Recording recording = SofterRope();
  SpringMassSystem stiff = MakeStartSystem(recording, {});
  stiff.stiffness *= 1e6;
  stiff.dashpot *= 30;
  ASSERT_GT(DiagnosisRate(stiff, recording.fps), 10000);
  const Fitting fitting({{stiff, true, DiagnosisBody::Kind::kTrusted, "rope"}},
                        {HoldOutFrames(recording)}, 1);
  const Descent descent = fitting.Begin(0, {});
  ASSERT_TRUE(std::isfinite(descent.misfit));
  EXPECT_EQ(
      fitting.Problem(descent.hypothesis, 0, Fitting::Care::kExact).SystemAt(descent.x).dashpot,
      stiff.dashpot);
}

// Stages make its sub-steps cost more than those of other bodies may.
TEST(Fitting, ABodyThatIsTrustedMayTakeTheStagesThatItCameWith) {
  const Recording recording = SofterRope();
  SpringMassSystem lossy = MakeStartSystem(recording, {});
  lossy.dashpot_stages = 6;
  while (DiagnosisRate(lossy, recording.fps) < 2500) lossy.dashpot *= 1.5;
  const Fitting fitting({{lossy, true, DiagnosisBody::Kind::kTrusted, "rope"}},
                        {HoldOutFrames(recording)}, 1);
  EXPECT_TRUE(std::isfinite(fitting.Begin(0, {}).misfit));
}

}  // namespace
}  // namespace physpring
