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
  const DiagnosisBody body{MakeStartSystem(recording, {}), true, true, "rope"};
  return Fitting({body}, {HoldOutFrames(recording)}, 1);
}

Eigen::VectorXd ResidualsAt(const Recording& recording, double gain) {
  const Fitting fitting = FittingOf(recording);
  const Descent descent = fitting.Begin(0, {});
  EffectProblem problem = fitting.Problem(descent.hypothesis, gain);
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
  fitting.Descend(0.5, 2, &descents);
  ASSERT_EQ(descents.size(), 1U);
  const auto verdict = fitting.Judge(descents[0]), same = judged.Judge(descents[0]);
  ASSERT_TRUE(verdict);
  ASSERT_TRUE(same);
  EXPECT_EQ(verdict->track.fit, same->track.fit);
  EXPECT_NE(verdict->track.held, same->track.held);
}

TEST(Fitting, ABodyThatIsTrustedMayBeAsStiffAsItCame) {
  const Recording recording = SofterRope();
  SpringMassSystem stiff = MakeStartSystem(recording, {});
  stiff.stiffness *= 1e6;
  stiff.dashpot *= 30;
  ASSERT_GT(DiagnosisRate(stiff, recording.fps), 10000);
  const Fitting fitting({{stiff, true, true, "rope"}}, {HoldOutFrames(recording)}, 1);
  const Descent descent = fitting.Begin(0, {});
  ASSERT_TRUE(std::isfinite(descent.misfit));
  EXPECT_EQ(fitting.Problem(descent.hypothesis, 0).SystemAt(descent.x).dashpot, stiff.dashpot);
}

}  // namespace
}  // namespace physpring
