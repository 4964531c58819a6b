// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "trainer/bodies/factors.h"
#include "trainer/motion/residual_correlation.h"
#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

// The sub-steps a second of a body that is tried first: a faster one has to be worth its time.
constexpr double kSlowRate = 2500;
// One that leaves less in the first part of the motions is fitted to all of them at once.
constexpr double kPerhapsNoise = 0.05;
// A body of a higher rate, or of more numbers at the hands, must lower the part of the error that
// is no noise to this share; one of more directions to this one.
constexpr double kWorthItsCost = 0.6, kWorthDirections = 0.8;
// Bodies that leave more cannot tell how controllers move dashpots.
constexpr double kLost = 0.5;
// One that wants more sub-steps than it may take is worse on another motion than it looks.
constexpr double kWantsSubsteps = 1.2;

// Parts of the work.
constexpr double kTriesDone = 0.7, kDirectionsDone = 0.8;

// A smooth body that is tried: of at most kSlowRate or of any rate; and the parts of the work that
// it ends at, roughly fitted and, if it is, to the end.
struct Try {
  const char* name;
  bool stiff, hands_apart;
  double roughly, to_the_end;
};
constexpr std::array<Try, 4> kTries = {
    {{"smooth body", false, false, 0.05, 0.2},
     {"smooth body, hands apart", false, true, 0.25, 0.35},
     {"smooth body, stiff", true, false, 0.45, 0.55},
     {"smooth body, stiff, hands apart", true, true, 0.65, kTriesDone}}};

// The loss time that a body of more sub-steps than kSlowRate starts with, relative to others: from
// a short one on, fits of bodies that lose much end in side valleys.
constexpr double kLossier = 30;

// A smooth body, and how much of its error is no noise.
struct SmoothTrial {
  ChosenBody model;  // with the treatment of the controllers' velocity that it was fitted with
  SmoothlyFitted fit;
  double correlation;  // residual_correlation.h
  double wrong_by;     // the part of the error that is no noise, m
  bool limited;        // it wants more sub-steps, and there are bodies that may take them

  bool HasArrived() const { return correlation < kSurelyNoise && !limited; }
};

// The first part of each motion, which shows smooth bodies the way.
std::vector<Episode> FirstPart(std::vector<Episode> episodes) {
  constexpr double kPart = 0.4;
  for (Episode& one : episodes) {
    one.frames = std::max(2, 1 + static_cast<int>(std::ceil(kPart * (one.frames - 1))));
  }
  return episodes;
}

// Whether they show enough points to tell noise from what is wrong.
bool TellNoise(const std::vector<Episode>& episodes) {
  constexpr double kLeastPoints = 1000;
  double points = 0;
  for (const Episode& one : episodes) points += (one.frames - 1.0) * one.recording->point_count();
  return points >= kLeastPoints;
}

// Whether the mesh of a net is irregular (spring_classes.h).
bool IsIrregular(const ChosenBody& model, const std::vector<Episode>& episodes, double rate) {
  return SoftSmoothBody(model, episodes, {rate}).body.factors().classes().irregular;
}

class SmoothChoice {
 public:
  SmoothChoice(const ChosenBody& model, const std::vector<Episode>& episodes,
               const TrainOptions& options, bool few, const Work& work)
      : model_(model),
        recording_(*episodes.at(0).recording),
        all_(episodes),
        first_(FirstPart(episodes)),
        judged_(TellNoise(first_) ? first_ : all_),
        options_(options),
        few_(few),
        work_(work),
        most_rate_(MostRate(options, recording_)),
        with_soft_springs_(!few && IsIrregular(model, first_, most_rate_)) {}

  SmoothlyChosen Run();

 private:
  bool HasHands() const { return recording_.controller_count() > 0; }
  SmoothlyFitted StartOf(const ChosenBody& model, const SmoothBody::Options& body) const {
    return SoftSmoothBody(with_soft_springs_ ? model.WithSoftSprings(recording_) : model, first_,
                          body, body.most_rate > kSlowRate ? kLossier : 1);
  }
  SmoothTrial Judge(const ChosenBody& model, const SmoothlyFitted& fit,
                    const std::vector<Episode>& episodes) const;
  SmoothTrial TryRoughly(const ChosenBody& model, const SmoothBody::Options& body,
                         const Work& work) const;
  SmoothTrial WithBetterCone(const SmoothTrial& trial, const Work& work) const;
  SmoothTrial WithBetterVelocity(const SmoothTrial& trial, const Work& work) const;
  SmoothTrial ToTheEnd(const SmoothTrial& trial, const Work& work) const;
  void Consider(const SmoothTrial& trial);
  void FitBest(const Work& work);
  void TryDirections(const Work& work);
  SmoothlyChosen Chosen() const {
    return {fitted_->fit, fitted_->model, fitted_->correlation, options_.substeps};
  }

  ChosenBody model_;  // of the next trial
  const Recording& recording_;
  const std::vector<Episode>& all_;
  std::vector<Episode> first_;          // the first part, which shows the way
  const std::vector<Episode>& judged_;  // what trials are compared by
  const TrainOptions& options_;
  bool few_;
  const Work& work_;
  double most_rate_;                          // sub-steps a second
  bool with_soft_springs_;                    // beyond the chosen net's radius
  std::optional<SmoothTrial> best_, fitted_;  // roughly, and to the end
  bool is_fitted_ = false;                    // whether best_ has been fitted to the end
};

SmoothTrial SmoothChoice::Judge(const ChosenBody& model, const SmoothlyFitted& fit,
                                const std::vector<Episode>& episodes) const {
  const SpringMassSystem system = fit.System();
  const RolloutOptions free = FollowOptions(recording_, model.body, options_).rollout;
  const double correlation = ResidualCorrelation(system, episodes, free);
  const double error = GeometricTrackError(system, episodes, FrameUse::kFit, free);
  const double next_rate = fit.body.most_rate() + recording_.fps;  // one sub-step more
  return {model, fit, correlation, std::sqrt(std::max(0.0, correlation)) * error,
          next_rate <= most_rate_ && fit.body.IsLimited(fit.x)};
}

// A body roughly fitted to the first part of the motions, which tells the side valleys apart that
// fits end in; of few points to all.
SmoothTrial SmoothChoice::TryRoughly(const ChosenBody& model, const SmoothBody::Options& body,
                                     const Work& work) const {
  SmoothlyFitted fit =
      FitRoughly(StartOf(model, body), GuidingGains(), model, first_, options_, work);
  if (&judged_ != &first_) {
    fit = FitRoughly(fit, {0}, model, judged_, options_, work.Stretch("all", 1, 1));
  }
  return Judge(model, fit, judged_);
}

// The trial, or the same body with the other cone of friction where that leaves less. It starts
// anew: a fit that slips the wrong way ends in a side valley.
SmoothTrial SmoothChoice::WithBetterCone(const SmoothTrial& trial, const Work& work) const {
  const SmoothTrial other = TryRoughly(trial.model.WithOtherCone(), trial.fit.body.options(), work);
  return other.wrong_by < trial.wrong_by ? other : trial;
}

// The trial, or the same body with the other treatment of the controllers' velocity where that
// leaves less.
SmoothTrial SmoothChoice::WithBetterVelocity(const SmoothTrial& trial, const Work& work) const {
  const ChosenBody model = trial.model.WithOtherVelocity();
  const SmoothTrial other =
      Judge(model, FitRoughly(trial.fit, {0}, model, judged_, options_, work), judged_);
  return other.wrong_by < trial.wrong_by ? other : trial;
}

// Whether a trial is better than the best one so far, and worth what it costs.
bool IsBetter(const SmoothTrial& trial, const SmoothTrial& best) {
  const SmoothBody &one = trial.fit.body, &other = best.fit.body;
  const bool costs_more =
      one.most_rate() > other.most_rate() || (one.hands_apart() && !other.hands_apart());
  double worth = costs_more ? kWorthItsCost : 1;
  if (one.directions() && !other.directions()) worth = std::min(worth, kWorthDirections);
  if (best.limited) worth = trial.limited ? worth : kWantsSubsteps;
  return trial.wrong_by < worth * best.wrong_by;
}

// The trial, fitted to the end. One that is far off in the first part would be lost in the rest
// without an observer.
SmoothTrial SmoothChoice::ToTheEnd(const SmoothTrial& trial, const Work& work) const {
  const ChosenBody& model = trial.model;
  SmoothlyFitted fit = trial.fit;
  if (trial.correlation >= kPerhapsNoise) {
    fit = FitRoughly(fit, LeadingGains(), model, all_, options_, work.Stretch("rest", 0, 0.3));
  }
  fit = FitToTheEnd(fit, model, all_, options_, work.Stretch("end", 0.3, 1));
  return Judge(model, fit, all_);
}

void SmoothChoice::Consider(const SmoothTrial& trial) {
  if (best_ && !IsBetter(trial, *best_)) return;
  best_ = trial;
  is_fitted_ = false;
}

void SmoothChoice::FitBest(const Work& work) {
  const SmoothTrial trial = ToTheEnd(*best_, work);
  if (!fitted_ || trial.HasArrived() || IsBetter(trial, *fitted_)) fitted_ = trial;
  is_fitted_ = true;
}

// Directions told apart in the best body, if its mesh has any. Where that body is lost, the
// question of the controllers' velocity was asked in vain, and both treatments are tried.
void SmoothChoice::TryDirections(const Work& work) {
  const SmoothBody& body = best_->fit.body;
  const SmoothBody::Options apart = {body.most_rate(), body.hands_apart(), true};
  if (StartOf(model_, apart).body.size() == body.size()) return;
  const bool lost = best_->correlation >= kLost;
  Consider(TryRoughly(model_, apart, work.Stretch("as found", 0, 0.5)));
  if (!lost || !HasHands() || options_.controller_velocity) return;
  Consider(TryRoughly(model_.WithOtherVelocity(), apart, work.Stretch("other velocity", 0.5, 1)));
}

// Bodies of long sub-steps come first, and of each those whose hands follow the law of the object.
SmoothlyChosen SmoothChoice::Run() {
  const double least = std::min(kSlowRate, most_rate_);
  bool velocity_is_open = HasHands() && !options_.controller_velocity;
  bool cone_is_open = recording_.ground && !options_.cone;
  double from = 0;
  for (const Try& one : kTries) {
    const double rate = one.stiff ? most_rate_ : least;
    if ((one.stiff && most_rate_ == least) || (one.hands_apart && (few_ || !HasHands()))) continue;
    SmoothTrial trial =
        TryRoughly(model_, {rate, one.hands_apart}, work_.Part(one.name, from, one.roughly));
    if (cone_is_open && trial.correlation >= kSurelyNoise) {
      trial = WithBetterCone(trial, work_.Stretch("cone", one.roughly, one.roughly));
      model_ = trial.model;
      cone_is_open = false;
    }
    if (velocity_is_open && trial.correlation >= kSurelyNoise && !trial.limited) {
      trial = WithBetterVelocity(trial, work_.Stretch("velocity", one.roughly, one.roughly));
      model_ = trial.model;
      velocity_is_open = false;
    }
    Consider(trial);
    if (!is_fitted_ && best_->correlation < kPerhapsNoise && !best_->limited) {
      const Work of_try = work_.Stretch(one.name, one.roughly, one.to_the_end);
      FitBest(of_try.Part("smooth body, to the end", 0, 1));
      if (fitted_->HasArrived()) return Chosen();
    }
    from = one.to_the_end;
  }
  if (!few_ && best_->correlation >= kNoiseCorrelation) {
    TryDirections(work_.Part("smooth body, directions apart", kTriesDone, kDirectionsDone));
  }
  if (!is_fitted_) FitBest(work_.Part("smooth body, to the end", kDirectionsDone, 1));
  return Chosen();
}

}  // namespace

SmoothlyChosen ChooseSmoothBody(const ChosenBody& model, const std::vector<Episode>& episodes,
                                const TrainOptions& options, bool few, const Work& work) {
  return SmoothChoice(model, episodes, options, few, work).Run();
}

}  // namespace physpring
