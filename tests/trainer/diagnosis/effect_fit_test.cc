// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/swung_rope.h"
#include "trainer/start_system.h"

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

EffectFitting FittingOf(const Recording& recording) {
  const DiagnosisBody body{MakeStartSystem(recording, {}), true, true, "rope"};
  return EffectFitting({body}, {HoldOutFrames(recording)}, 1);
}

Eigen::VectorXd ResidualsAt(const Recording& recording, double gain) {
  const EffectFitting fitting = FittingOf(recording);
  const EffectFit fit = fitting.Begin(0, {});
  EffectProblem problem = fitting.Problem(fit, gain);
  problem.FixSubsteps(fit.x);
  return *problem.Residuals(fit.x);
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

TEST(EffectFitting, AnObserverMakesResidualsSmaller) {
  const Recording recording = SofterRope();
  EXPECT_LT(ResidualsAt(recording, 0.5).norm(), 0.5 * ResidualsAt(recording, 0).norm());
}

TEST(EffectFitting, AnObserverSeesNoHeldOutFrames) {
  const Recording recording = SofterRope();
  const Recording other = WithOtherHeldFrames(recording);
  ASSERT_NE(HoldOutFrames(recording).last(Use::kHeld), 0);
  EXPECT_EQ(ResidualsAt(recording, 0.5), ResidualsAt(other, 0.5));
}

TEST(EffectFitting, JudgesWithoutAnObserver) {
  const Recording recording = SofterRope();
  const Recording other = WithOtherHeldFrames(recording);
  const EffectFitting fitting = FittingOf(recording), judged = FittingOf(other);
  EffectFit fit = fitting.Begin(0, {}), same = fit;
  std::vector<EffectFit> fits = {fit};
  fitting.Descend(0.5, 2, &fits);
  ASSERT_EQ(fits.size(), 1U);
  same = fits[0];
  ASSERT_TRUE(fitting.Judge(&fits[0]));
  ASSERT_TRUE(judged.Judge(&same));
  EXPECT_EQ(fits[0].track.fit, same.track.fit);
  EXPECT_NE(fits[0].track.held, same.track.held);
}

TEST(EffectFitting, ABodyThatIsTrustedMayBeAsStiffAsItCame) {
  const Recording recording = SofterRope();
  SpringMassSystem stiff = MakeStartSystem(recording, {});
  stiff.stiffness *= 1e6;
  stiff.dashpot *= 30;
  ASSERT_GT(DiagnosisRate(stiff, recording.fps), 10000);
  const EffectFitting fitting({{stiff, true, true, "rope"}}, {HoldOutFrames(recording)}, 1);
  const EffectFit fit = fitting.Begin(0, {});
  ASSERT_TRUE(std::isfinite(fit.misfit));
  EXPECT_EQ(fitting.Problem(fit, 0).SystemAt(fit.x).dashpot, stiff.dashpot);
}

}  // namespace
}  // namespace physpring
