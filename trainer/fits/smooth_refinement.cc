// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_refinement.h"

#include <fmt/format.h>

#include <algorithm>

#include "trainer/bodies/factors.h"
#include "trainer/fits/superfluous_springs.h"
#include "trainer/motion/residual_correlation.h"
#include "trainer/motion/track_error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// Fewer springs may raise the error by this part: the others bend a little to the motion, too.
constexpr double kMostLoss = 0.02;
constexpr double kLeastGain = 0.005;             // shorter sub-steps must lower it by this part
constexpr int kMostRounds = 3;                   // of leaving springs out
constexpr double kFiner = 3, kLeastFiner = 1.5;  // times the sub-steps
constexpr double kSparseDone = 0.4, kFinerDone = 0.9;

// Whether a number of sub-steps a frame is the same time step in all of them.
bool HaveOneFrameRate(const std::vector<Episode>& episodes) {
  return std::all_of(episodes.begin(), episodes.end(), [&](const Episode& one) {
    return one.recording->fps == episodes[0].recording->fps;
  });
}

class Refinement {
 public:
  Refinement(const SmoothlyChosen& chosen, const std::vector<Episode>& episodes,
             const TrainOptions& options)
      : best_(chosen),
        recording_(OnlyFitFrames(episodes.at(0))),
        episodes_(episodes),
        options_(options) {
    options_.substeps = chosen.substeps;
  }

  void LeaveOutSprings(const Work& work);
  bool ShortenSubsteps(const Work& work);  // whether it did
  const SmoothlyChosen& Best() const { return best_; }

 private:
  RolloutOptions FreeMotion() const {
    return FollowOptions(recording_, best_.model.body, options_).rollout;
  }
  double ErrorOf(const SmoothlyFitted& fit) const {
    return GeometricTrackError(fit.System(), episodes_, FrameUse::kFit, FreeMotion());
  }
  void Take(const SmoothlyFitted& fit) {
    best_.fit = fit;
    best_.correlation = ResidualCorrelation(fit.System(), episodes_, FreeMotion());
    best_.substeps = options_.substeps;
  }

  SmoothlyChosen best_;
  Recording recording_;
  const std::vector<Episode>& episodes_;
  TrainOptions options_;  // with the sub-steps of the best one
};

void Refinement::LeaveOutSprings(const Work& work) {
  for (int round = 0; round < kMostRounds; ++round) {
    const auto start = WithoutSuperfluousSprings(best_.fit, recording_, *best_.model.body.kind);
    if (!start) return;
    const SmoothlyFitted sparse = FitToTheEnd(*start, best_.model, episodes_, options_,
                                              work.Stretch(fmt::format("round {}", round), 0, 1));
    if (ErrorOf(sparse) > (1 + kMostLoss) * ErrorOf(best_.fit)) return;
    Take(sparse);
  }
}

bool Refinement::ShortenSubsteps(const Work& work) {
  const bool open = options_.substeps == 0 && HaveOneFrameRate(episodes_);
  if (!open || best_.correlation >= kNoiseCorrelation) return false;
  const double coarse_error = ErrorOf(best_.fit);
  const int stable =
      StableSubsteps(ComputeStabilityBound(best_.fit.System()), 1 / recording_.fps, kStepSafety);
  const int most = static_cast<int>(MostRate(options_, recording_) / recording_.fps);
  const int finer = std::min(static_cast<int>(kFiner * stable), most);
  if (finer < kLeastFiner * stable) return false;
  SmoothBody::Options freer = best_.fit.body.options();
  freer.most_rate = finer * recording_.fps;
  const SmoothBody body(best_.fit.body.factors().base(), recording_, *best_.model.body.kind, freer);
  options_.substeps = finer;
  const SmoothlyFitted fit =
      FitToTheEnd({body, best_.fit.x}, best_.model, episodes_, options_, work);
  if (ErrorOf(fit) >= (1 - kLeastGain) * coarse_error) {
    options_.substeps = best_.substeps;
    return false;
  }
  Take(fit);
  return true;
}

}  // namespace

SmoothlyChosen Refine(const SmoothlyChosen& chosen, const std::vector<Episode>& episodes,
                      const TrainOptions& options, const Work& work) {
  Refinement refinement(chosen, episodes, options);
  refinement.LeaveOutSprings(work.Part("superfluous springs", 0, kSparseDone));
  if (refinement.ShortenSubsteps(work.Part("shorter sub-steps", kSparseDone, kFinerDone))) {
    refinement.LeaveOutSprings(work.Part("superfluous springs again", kFinerDone, 1));
  }
  return refinement.Best();
}

}  // namespace physpring
