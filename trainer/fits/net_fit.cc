// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/net_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
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
// With a smooth body whose residuals correlate less, nothing else is tried. One that is too slow
// may leave little more than noise on the fit frames, and far more on another motion.
constexpr double kSurelyNoise = 0.01;
// A body of a higher rate, or of more numbers at the hands, must lower the part of the error that
// is no noise to this share.
constexpr double kWorthItsCost = 0.6;
constexpr double kWorthIt = 0.95;  // bodies of more numbers must lower the error to this share

// Parts of the work, as measured on recordings of 80 to 500 particles.
constexpr double kSlowPart = 0.1, kSmoothPart = 0.3, kTriedSmooth = 0.35, kTriedStiffnesses = 0.45,
                 kTried = 0.6;

enum class Kind { kSmooth, kStiffnesses, kSprings };

// A smooth body, and how much of its error is no noise.
struct SmoothTrial {
  SmoothlyFitted fit;
  double correlation;  // residual_correlation.h
  double wrong_by;     // the part of the error that is no noise, m
  bool limited;        // it would be stiffer or lossier if it might take more sub-steps

  bool HasArrived() const { return correlation < kSurelyNoise && !limited; }
};

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
  SmoothTrial TrySmooth(const SmoothBody::Options& body, const Work& work) const;
  SmoothTrial FitSmooth() const;
  Kind BestPredictor(const SmoothTrial& smooth) const;
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
  const Parameters springs = SpringFactors(model.System(first), first, *model.body.kind);
  return springs.Apply(FitSprings(springs, model.body, data, options, x, work));
}

// The springs' own stiffnesses, fitted to `data` from a smooth body on.
SpringMassSystem FitStiffnesses(const SpringMassSystem& smooth, const Body& body,
                                const FitData& data, const TrainOptions& options,
                                const Work& work) {
  const Parameters springs = StiffnessFactors(smooth, data.recordings.at(0), *body.kind);
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(springs.size());
  return springs.Apply(FitSprings(springs, body, data, options, start, work));
}

Eigen::VectorXd NoOwnValues(const ChosenBody& model, const Recording& first) {
  return Eigen::VectorXd::Zero(SpringFactors(model.System(first), first, *model.body.kind).size());
}

SmoothTrial NetFit::TrySmooth(const SmoothBody::Options& body, const Work& work) const {
  const SmoothlyFitted fit = FitSmoothBody(model(), episodes_, options_, body, work);
  const SpringMassSystem system = fit.System();
  const double correlation = ResidualCorrelation(system, episodes_, rollout_);
  const double error = GeometricTrackError(system, episodes_, FrameUse::kFit, rollout_);
  return {fit, correlation, std::sqrt(std::max(0.0, correlation)) * error,
          fit.body.IsLimited(fit.x)};
}

// The first smooth body that has arrived, or the best of them. Those of long sub-steps come first,
// and of each those whose hands follow the law of the object. They differ in which side valleys
// their fits end in.
SmoothTrial NetFit::FitSmooth() const {
  const double most = MostRate(options_, data_.recordings[0]), least = std::min(kSlowRate, most);
  const bool hands = data_.recordings[0].controller_count() > 0;
  std::optional<SmoothTrial> best;
  const auto is_better = [&](const SmoothTrial& trial) {
    if (!best || trial.HasArrived()) return true;
    const SmoothBody &one = trial.fit.body, &other = best->fit.body;
    const bool costs_more =
        one.most_rate() > other.most_rate() || (one.hands_apart() && !other.hands_apart());
    const double worth = costs_more ? kWorthItsCost : 1;
    return trial.wrong_by < worth * best->wrong_by;
  };
  double from = 0;
  const auto take = [&](double rate, bool apart, const char* name, double to) {
    const SmoothTrial trial = TrySmooth({rate, apart}, work_.Part(name, from, to));
    from = to;
    if (is_better(trial)) best = trial;
  };
  take(least, false, "smooth body", 0.5 * kSlowPart);
  if (hands && !best->limited && !best->HasArrived()) {
    take(least, true, "smooth body, hands apart", kSlowPart);
  }
  if (most > least && !best->HasArrived()) {
    take(most, false, "smooth body, stiff", 0.5 * (kSlowPart + kSmoothPart));
    if (hands && !best->HasArrived()) {
      take(most, true, "smooth body, stiff, hands apart", kSmoothPart);
    }
  }
  return *best;
}

// What predicts best what is held back; of bodies that predict about as well, the one of the fewest
// numbers.
Kind NetFit::BestPredictor(const SmoothTrial& smooth) const {
  const HeldBackMotion held_back = HoldBackMotion(data_, kMostCommonRecordings);
  const std::vector<Episode> judged = held_back.JudgedEpisodes();
  const std::vector<Episode> fit = FitEpisodes(held_back.fit, kMostCommonRecordings);
  Kind best = Kind::kSmooth;
  double least = kInfinity;
  const auto judge = [&](Kind kind, const SpringMassSystem& system) {
    const double error = GeometricTrackError(system, judged, FrameUse::kHeld, rollout_);
    if (error >= kWorthIt * least) return;
    best = kind;
    least = error;
  };
  const SpringMassSystem tried = FitOn(smooth.fit, model(), fit, options_,
                                       work_.Part("trial, smooth body", kSmoothPart, kTriedSmooth))
                                     .System();
  judge(Kind::kSmooth, tried);
  judge(Kind::kStiffnesses,
        FitStiffnesses(tried, model().body, held_back.fit, options_,
                       work_.Part("trial, stiffnesses", kTriedSmooth, kTriedStiffnesses)));
  if (smooth.correlation >= kNoiseCorrelation) {
    judge(Kind::kSprings,
          FitSpringsOf(model(), held_back.fit, options_,
                       NoOwnValues(model(), held_back.fit.recordings.at(0)),
                       work_.Part("trial, single springs", kTriedStiffnesses, kTried)));
  }
  return best;
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
  const SmoothTrial smooth = FitSmooth();
  SpringMassSystem system = smooth.fit.System();
  if (smooth_only || smooth.correlation < kSurelyNoise) return system;
  switch (BestPredictor(smooth)) {
    case Kind::kStiffnesses:
      return FitStiffnesses(system, model().body, data_, options_,
                            work_.Part("stiffnesses", kTried, 1));
    case Kind::kSprings:
      return FitAllSprings(kTried);
    case Kind::kSmooth:
      break;
  }
  return system;
}

}  // namespace

SpringMassSystem FitNet(const BodyChoice& choice, const FitData& data, const TrainOptions& options,
                        const Work& work) {
  return NetFit(choice, data, options, work).Run();
}

}  // namespace physpring
