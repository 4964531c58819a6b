// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "trainer/bodies/factors.h"
#include "trainer/fits/prior_widths.h"
#include "trainer/fits/superfluous_springs.h"
#include "trainer/motion/residual_correlation.h"
#include "trainer/motion/track_error.h"
#include "twin/checks/motion_scale.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// Fewer springs, or a narrower prior, may raise the error by this part: others bend a little to the
// motion, too.
constexpr double kMostLoss = 0.02;
// Shorter sub-steps must lower the misfit by so much, in variances of the noise. One more number of
// a body lowers it by about 1 (Wilks, Annals of Mathematical Statistics 9, 1938). Single springs
// fewer may raise it by that much.
constexpr double kLeastGainOfSteps = 5, kMostRiseOfSprings = 20;
constexpr double kFiner = 3, kLeastFiner = 1.1;  // times the sub-steps
constexpr int kMostRounds = 6;                   // of each refinement
// Times the best error: a fit that starts with more is led by an observer first.
constexpr double kNearby = 1.05;
// A new start may fit worse by this part: its body is the simpler one. Its prior holds classes as
// near to the law of all springs as this.
constexpr double kMostLossOfStart = 0.005, kAlikeClasses = 0.12;
// Parts of the work.
constexpr double kSparseDone = 0.3, kFinerDone = 0.6, kStartDone = 0.8, kSparseAgain = 0.85,
                 kFinerAgain = 0.92;

// Whether a number of sub-steps a frame is the same time step in all of them.
bool HaveOneFrameRate(const std::vector<Episode>& episodes) {
  return std::all_of(episodes.begin(), episodes.end(), [&](const Episode& one) {
    return one.recording->fps == episodes[0].recording->fps;
  });
}

// How many coordinates are measured, at most.
double MeasuredCoordinates(const std::vector<Episode>& episodes) {
  double count = 0;
  for (const Episode& one : episodes)
    count += 3 * (one.frames - 1.0) * one.recording->point_count();
  return count;
}

// The same stiffness times length, the median of all, for all springs of the object, and one loss
// time for all.
SpringMassSystem Uniform(SpringMassSystem system) {
  std::vector<int> of_object;
  std::vector<double> axial;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (system.IsControllerSpring(e)) continue;
    of_object.push_back(e);
    axial.push_back(system.stiffness[e] * system.rest_length[e]);
  }
  const double median = Median(std::move(axial));
  const double loss_time = system.dashpot.sum() / system.stiffness.sum();
  for (int e : of_object) system.stiffness[e] = median / system.rest_length[e];
  system.dashpot = loss_time * system.stiffness;
  return system;
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
    best_error_ = ErrorOf(best_.fit);
  }

  void LeaveOutSprings(const Work& work);
  void ShortenSubsteps(const Work& work);
  void StartAnew(const Work& work);
  void SettleWidths(const Work& work);
  bool LeavesNoise() const { return best_.correlation < kNoiseCorrelation; }
  const SmoothlyChosen& Best() const { return best_; }

 private:
  RolloutOptions FreeMotion() const {
    return FollowOptions(recording_, best_.model.body, options_).rollout;
  }
  double ErrorOf(const SmoothlyFitted& fit) const {
    return GeometricTrackError(fit.System(), episodes_, FrameUse::kFit, FreeMotion());
  }
  // By how much a fit of this error lowers the misfit, in variances of the noise.
  double Gain(double error) const {
    return MeasuredCoordinates(episodes_) * (1 - std::pow(error / best_error_, 2));
  }
  SmoothlyFitted ToTheEnd(const SmoothlyFitted& start, const Work& work) const {
    return FitToTheEnd(start, best_.model, episodes_, options_, work);
  }
  // Led back to the motion first, where the start is so far from it that it would be lost.
  SmoothlyFitted NotLost(const SmoothlyFitted& start, const Work& work) const {
    if (ErrorOf(start) <= kNearby * best_error_) return ToTheEnd(start, work);
    return LedToTheEnd(start, work);
  }
  SmoothlyFitted LedToTheEnd(const SmoothlyFitted& start, const Work& work) const {
    const SmoothlyFitted led = FitRoughly(start, LeadingGains(), best_.model, episodes_, options_,
                                          work.Stretch("rough", 0, 0.3));
    return ToTheEnd(led, work.Stretch("end", 0.3, 1));
  }
  static Work Round(const Work& work, int round) {
    return work.Stretch(fmt::format("round {}", round), 0, 1);
  }
  void Take(const SmoothlyFitted& fit, double error) {
    best_.fit = fit;
    best_.correlation = ResidualCorrelation(fit.System(), episodes_, FreeMotion());
    best_.substeps = options_.substeps;
    best_error_ = error;
  }

  SmoothlyChosen best_;
  double best_error_ = 0;  // m
  Recording recording_;
  const std::vector<Episode>& episodes_;
  TrainOptions options_;  // with the sub-steps of the best one
};

void Refinement::LeaveOutSprings(const Work& work) {
  for (int round = 0; round < kMostRounds; ++round) {
    const auto start = WithoutSuperfluousSprings(best_.fit, recording_, *best_.model.body.kind);
    if (!start) return;
    const SmoothlyFitted sparse = NotLost(*start, Round(work, round));
    const double error = ErrorOf(sparse);
    const bool single = best_.fit.body.options().finer.springs == 1;
    if (single ? Gain(error) < -kMostRiseOfSprings : error > (1 + kMostLoss) * best_error_) return;
    Take(sparse, error);
  }
}

void Refinement::ShortenSubsteps(const Work& work) {
  if (options_.substeps != 0 || !HaveOneFrameRate(episodes_)) return;
  const int most = static_cast<int>(MostRate(options_, recording_) / recording_.fps);
  for (int round = 0; round < kMostRounds; ++round) {
    const int stable = CutFrames(1 / recording_.fps, 0, best_.fit.System()).substeps;
    const int now = std::max(stable, best_.substeps);
    const bool limited = best_.fit.body.IsLimited(best_.fit.x);
    const int finer = limited ? most : std::min(static_cast<int>(kFiner * now), most);
    if (finer < kLeastFiner * now) return;
    SmoothBody::Options freer = best_.fit.body.options();
    freer.most_rate = std::max(freer.most_rate, finer * recording_.fps);
    const SmoothBody body(best_.fit.body.factors().base(), recording_, *best_.model.body.kind,
                          freer);
    options_.substeps = finer;
    const SmoothlyFitted fit = ToTheEnd({body, best_.fit.x}, Round(work, round));
    const double error = ErrorOf(fit);
    if (Gain(error) < kLeastGainOfSteps) {
      options_.substeps = best_.substeps;
      return;
    }
    Take(fit, error);
  }
}

void Refinement::StartAnew(const Work& work) {
  SmoothlyFitted start = best_.fit;
  SmoothBody::Widths widths;
  widths.classes = kAlikeClasses;
  start.body.SetWidths(widths);
  start.x = start.body.NumbersLike(Uniform(best_.fit.System()), best_.fit.x);
  const SmoothlyFitted fit = LedToTheEnd(start, work);
  const double error = ErrorOf(fit);
  if (error <= (1 + kMostLossOfStart) * best_error_) Take(fit, error);
}

void Refinement::SettleWidths(const Work& work) {
  for (int round = 0; round < kMostRounds; ++round) {
    const auto linearised = LineariseFit(best_.fit, best_.model, episodes_, options_);
    if (!linearised) return;
    SmoothlyFitted start = best_.fit;
    start.body.SetWidths(MostProbableWidths(best_.fit, *linearised));
    if (start.body.options().widths == best_.fit.body.options().widths) return;
    const SmoothlyFitted fit = ToTheEnd(start, Round(work, round));
    const double error = ErrorOf(fit);
    if (error > (1 + kMostLoss) * best_error_) return;
    Take(fit, error);
  }
}

}  // namespace

SmoothlyChosen Refine(const SmoothlyChosen& chosen, const std::vector<Episode>& episodes,
                      const TrainOptions& options, const Work& work) {
  Refinement refinement(chosen, episodes, options);
  refinement.LeaveOutSprings(work.Part("superfluous springs", 0, kSparseDone));
  if (!refinement.LeavesNoise()) return refinement.Best();
  refinement.ShortenSubsteps(work.Part("shorter sub-steps", kSparseDone, kFinerDone));
  refinement.StartAnew(work.Part("a uniform start", kFinerDone, kStartDone));
  refinement.LeaveOutSprings(work.Part("superfluous springs again", kStartDone, kSparseAgain));
  refinement.ShortenSubsteps(work.Part("shorter sub-steps again", kSparseAgain, kFinerAgain));
  refinement.SettleWidths(work.Part("widths of priors", kFinerAgain, 1));
  return refinement.Best();
}

}  // namespace physpring
