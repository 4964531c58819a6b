// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/net_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "trainer/data/held_back.h"
#include "trainer/fits/factor_fit.h"
#include "trainer/fits/smooth_fit.h"
#include "trainer/fits/spring_fit.h"
#include "trainer/motion/residual_correlation.h"
#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

constexpr int kMostCommonRecordings = 4;  // smooth bodies are fitted to no more than these
constexpr GainSchedule kAllGains{0, 6};
// The sub-steps a second of a body that is tried first: a faster one has to be worth its time.
constexpr double kSlowRate = 2500;
// With a body whose residuals correlate less, no faster one is tried: one that is too slow may
// leave little more than noise on the fit frames, and far more on another motion.
constexpr double kSurelyNoise = 0.02;
// A body of a higher rate must lower the part of the error that is no noise to this share.
constexpr double kWorthItsRate = 0.6;
constexpr double kWorthIt = 0.95;  // single springs must lower the error to this share

// Parts of the work, as measured on recordings of 80 to 500 particles.
constexpr double kSlow = 0.1, kSmooth = 0.3, kTriedSmooth = 0.35, kTried = 0.6;

class NetFit {
 public:
  NetFit(const BodyChoice& choice, const FitData& data, const TrainOptions& options,
         const Work& work)
      : choice_(choice),
        data_(data),
        options_(options),
        work_(work),
        episodes_(FitEpisodes(data, kMostCommonRecordings)),
        rollout_(FollowOptions(data.recordings.at(0), choice.model.body, options).rollout) {}

  SpringMassSystem Run() const;

 private:
  const ChosenBody& model() const { return choice_.model; }
  double Correlation(const SmoothlyFitted& smooth) const {
    return ResidualCorrelation(smooth.System(), episodes_, rollout_);
  }
  bool HasArrived(const SmoothlyFitted& smooth) const {
    return Correlation(smooth) < kNoiseCorrelation;
  }
  // The part of the error that is no noise, m.
  double WrongBy(const SmoothlyFitted& smooth) const {
    return std::sqrt(std::max(0.0, Correlation(smooth))) *
           GeometricTrackError(smooth.System(), episodes_, FrameUse::kFit, rollout_);
  }
  SmoothlyFitted FitSmooth() const;
  bool PredictBetter(const SmoothlyFitted& smooth) const;
  SpringMassSystem FitAllSprings(double from) const;

  const BodyChoice& choice_;
  const FitData& data_;
  const TrainOptions& options_;
  const Work& work_;
  std::vector<Episode> episodes_;  // all fit frames
  RolloutOptions rollout_;         // a free motion
};

// The springs' own values, fitted to `data` from `x` on.
SpringMassSystem FitSpringsOf(const ChosenBody& model, const FitData& data,
                              const TrainOptions& options, const Eigen::VectorXd& x,
                              const Work& work) {
  const Recording& first = data.recordings.at(0);
  return SpringFactors(model.System(first), first, *model.body.kind)
      .Apply(FitSprings(model, data, options, x, work));
}

Eigen::VectorXd NoOwnValues(const ChosenBody& model, const Recording& first) {
  return Eigen::VectorXd::Zero(SpringFactors(model.System(first), first, *model.body.kind).size());
}

// The smooth body; of two that have not arrived, the one whose sub-steps are long, unless the other
// is much better.
SmoothlyFitted NetFit::FitSmooth() const {
  const double most = MostRate(options_, data_.recordings[0]), least = std::min(kSlowRate, most);
  const SmoothlyFitted slow =
      FitSmoothBody(model(), episodes_, options_, least, work_.Part("smooth body", 0, kSlow));
  if (least == most || Correlation(slow) < kSurelyNoise) return slow;
  const SmoothlyFitted fast = FitSmoothBody(model(), episodes_, options_, most,
                                            work_.Part("smooth body, stiff", kSlow, kSmooth));
  return WrongBy(fast) < kWorthItsRate * WrongBy(slow) ? fast : slow;
}

// Whether single springs predict what is held back better than the smooth body.
bool NetFit::PredictBetter(const SmoothlyFitted& smooth) const {
  const HeldBackMotion held_back = HoldBackMotion(data_, kMostCommonRecordings);
  const std::vector<Episode> judged = held_back.JudgedEpisodes();
  const auto error = [&](const SpringMassSystem& system) {
    return GeometricTrackError(system, judged, FrameUse::kHeld, rollout_);
  };
  const std::vector<Episode> fit = FitEpisodes(held_back.fit, kMostCommonRecordings);
  const SmoothlyFitted tried_smooth = FitOn(
      smooth, model(), fit, options_, work_.Part("trial, smooth body", kSmooth, kTriedSmooth));
  const SpringMassSystem tried_springs = FitSpringsOf(
      model(), held_back.fit, options_, NoOwnValues(model(), held_back.fit.recordings.at(0)),
      work_.Part("trial, single springs", kTriedSmooth, kTried));
  return error(tried_springs) < kWorthIt * error(tried_smooth.System());
}

// Single springs, fitted to all data in the work from `from` on.
SpringMassSystem NetFit::FitAllSprings(double from) const {
  if (choice_.springs.size() > 0 && GaussNewtonSteps(options_) > 0) {
    return FitSpringsOf(model(), data_, options_, choice_.springs,
                        work_.Part("single springs", from, 1));
  }
  ChosenBody start = model();
  start.factors = start.start;
  const double common = from + 0.1 * (1 - from);
  start = FitCommonFactors(start, episodes_, options_, kAllGains,
                           work_.Part("common factors", from, common));
  return FitSpringsOf(start, data_, options_, NoOwnValues(start, data_.recordings.at(0)),
                      work_.Part("single springs", common, 1));
}

SpringMassSystem NetFit::Run() const {
  const bool smooth_only = options_.method == TrainOptions::Method::kSmooth;
  const bool springs_asked =
      options_.epochs > 0 || options_.optimizer != TrainOptions::Optimizer::kAutomatic;
  if (springs_asked && !smooth_only) return FitAllSprings(0);
  const SmoothlyFitted smooth = FitSmooth();
  if (smooth_only || HasArrived(smooth) || !PredictBetter(smooth)) return smooth.System();
  return FitAllSprings(kTried);
}

}  // namespace

SpringMassSystem FitNet(const BodyChoice& choice, const FitData& data, const TrainOptions& options,
                        const Work& work) {
  return NetFit(choice, data, options, work).Run();
}

}  // namespace physpring
