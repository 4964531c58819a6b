// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/smooth_refit.h"

#include <algorithm>
#include <utility>

#include "trainer/bodies/spring_net.h"
#include "trainer/fits/smooth_fit.h"
#include "trainer/solvers/parallel.h"

namespace physpring {
namespace {

// Sub-steps a second at most, as of common factors.
constexpr double kMostSmoothRate = 5000;
const std::vector<double> kGuidingGains = {0.2, 0.1};  // of the observer, before the motion is free

// The verdict's system, with one loss time for all springs.
SpringMassSystem MaterialOf(const Verdict& verdict) {
  SpringMassSystem start = verdict.system;
  start.dashpot = start.stiffness * (start.dashpot.sum() / start.stiffness.sum());
  return start;
}

Verdict Refit(const Fitting& fitting, const Verdict& verdict, int threads, const Work& work) {
  const Recording& recording = *fitting.recordings()[0].recording;
  const DiagnosisBody& body = fitting.bodies()[verdict.descent.hypothesis.body];
  std::vector<SplitRecording> splits;  // an observer is not to see held-out frames
  for (const SplitRecording& split : fitting.recordings()) splits.push_back(DropHeldOut(split));
  std::vector<Episode> episodes;
  for (const SplitRecording& split : splits) {
    if (split.last(FrameUse::kFit) > 0) {
      episodes.push_back(split.First(split.last(FrameUse::kFit)));
    }
  }
  const SpringMassSystem start = MaterialOf(verdict);
  SmoothBody::Options options{kMostSmoothRate, true};
  options.free_effects = static_cast<int>(start.effects.size() - body.base.effects.size());
  const SmoothBody smooth(start, recording, SpringNet(), options);
  ChosenBody chosen;
  chosen.body.kind = &SpringNet();
  chosen.body.controller_velocity = verdict.controller_velocity;
  TrainOptions train;
  train.threads = threads;
  const SmoothlyFitted guided =
      FitRoughly({smooth, Eigen::VectorXd::Zero(smooth.size())}, kGuidingGains, chosen, episodes, train,
                 work.Stretch("guided", 0, 0.4));
  const SmoothlyFitted fitted =
      FitToTheEnd(guided, chosen, episodes, train, work.Stretch("free", 0.4, 1));
  const auto judged = fitting.JudgeSystem(fitted.System(), verdict);
  if (!judged) return verdict;
  Verdict refitted = *judged;
  refitted.provenance = Verdict::Provenance::kSmooth;
  return refitted;
}

}  // namespace

std::vector<Verdict> RefitSmoothly(const Fitting& fitting, const WorkShare& stage,
                                   const std::string& of, const std::vector<Verdict>& verdicts) {
  const auto count = static_cast<int>(verdicts.size());
  std::vector<Verdict> refitted = verdicts;
  const int each = std::max(1, fitting.threads() / std::max(1, count));
  ParallelFor(count, fitting.threads(), [&](int i) {
    Verdict& verdict = refitted[static_cast<std::size_t>(i)];
    PieceKey key = KeyOf("smooth body", verdict.descent.hypothesis);
    key.Add(verdict.descent.x);
    const Work work(&fitting.journal(), key, stage, "refitting smoothly" + of + ": ");
    verdict = Refit(fitting, verdict, each, work.Item(i, count));
  });
  return refitted;
}

}  // namespace physpring
