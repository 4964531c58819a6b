// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/net_fit.h"

#include <algorithm>
#include <array>
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

// Single values are tried for no more particles in frames (held_back.h).
constexpr double kMostParticleFrames = 1e5;
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
constexpr double kSmoothPart = 0.3, kAllFramesPart = 0.35, kTriedSmooth = 0.4,
                 kTriedStiffnesses = 0.45, kTried = 0.6, kCommon = 0.65;

// A smooth body that is tried: of at most kSlowRate or of any rate; and the parts of the work that
// its fit ends at, with one treatment of the controllers' velocity and with both.
struct Try {
  const char* name;
  bool stiff, hands_apart;
  double fitted, with_velocity;
};
constexpr std::array<Try, 4> kTries = {
    {{"smooth body", false, false, 0.05, 0.07},
     {"smooth body, hands apart", false, true, 0.12, 0.14},
     {"smooth body, stiff", true, false, 0.2, 0.22},
     {"smooth body, stiff, hands apart", true, true, 0.28, kSmoothPart}}};

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
  NetFit(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
         const Work& work)
      : model_(chosen),
        data_(data),
        options_(options),
        work_(work),
        short_(ShortMotions(data, kMostCommonRecordings)),
        enough_(FitEpisodes(short_, kMostCommonRecordings)),
        episodes_(FitEpisodes(data, kMostCommonRecordings)) {}

  FittedNet Run();

 private:
  bool HasHands() const { return data_.recordings[0].controller_count() > 0; }
  RolloutOptions FreeMotion(const Body& body) const {
    return FollowOptions(data_.recordings[0], body, options_).rollout;
  }
  double ErrorOf(const ChosenBody& model) const {
    return GeometricTrackError(model.System(data_.recordings[0]), episodes_, FrameUse::kFit,
                               FreeMotion(model.body));
  }
  SmoothTrial Judge(const SmoothlyFitted& fit, const Body& body) const;
  SmoothTrial WithBetterVelocity(const SmoothTrial& trial, const Work& work);
  SmoothTrial FitSmooth();
  Kind BestPredictor(const SmoothTrial& smooth) const;
  ChosenBody WithCommonFactors(const ChosenBody& model, const Work& work) const;
  FittedNet FitSpringsAlone() const;

  ChosenBody model_;
  const FitData& data_;
  const TrainOptions& options_;
  const Work& work_;
  FitData short_;
  std::vector<Episode> enough_;    // as many fit frames as smooth bodies are tried on
  std::vector<Episode> episodes_;  // all fit frames
};

// The system with values of its springs' own, fitted to `data` from none on.
SpringMassSystem WithOwnValues(const Parameters& springs, const Body& body, const FitData& data,
                               const TrainOptions& options, const Work& work) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(springs.size());
  return springs.Apply(FitSprings(springs, body, data, options, none, work));
}

SpringMassSystem FitSpringsOf(const ChosenBody& model, const FitData& data,
                              const TrainOptions& options, const Work& work) {
  const Recording& first = data.recordings.at(0);
  return WithOwnValues(SpringFactors(model.System(first), first, *model.body.kind), model.body,
                       data, options, work);
}

SpringMassSystem FitStiffnesses(const SpringMassSystem& smooth, const Body& body,
                                const FitData& data, const TrainOptions& options,
                                const Work& work) {
  return WithOwnValues(StiffnessFactors(smooth, data.recordings.at(0), *body.kind), body, data,
                       options, work);
}

bool AsksForSprings(const TrainOptions& options) {
  return options.method == TrainOptions::Method::kFull &&
         (options.epochs > 0 || options.optimizer != TrainOptions::Optimizer::kAutomatic);
}

SmoothTrial NetFit::Judge(const SmoothlyFitted& fit, const Body& body) const {
  const SpringMassSystem system = fit.System();
  const double correlation = ResidualCorrelation(system, enough_, FreeMotion(body));
  const double error = GeometricTrackError(system, enough_, FrameUse::kFit, FreeMotion(body));
  return {fit, correlation, std::sqrt(std::max(0.0, correlation)) * error,
          fit.body.IsLimited(fit.x)};
}

ChosenBody WithOtherVelocity(ChosenBody model) {
  model.body.controller_velocity = !model.body.controller_velocity;
  return model;
}

// The trial, or the same body with the other treatment of the controllers' velocity where that
// leaves less: model_ then has it.
SmoothTrial NetFit::WithBetterVelocity(const SmoothTrial& trial, const Work& work) {
  const ChosenBody model = WithOtherVelocity(model_);
  const SmoothTrial other = Judge(FitOn(trial.fit, model, enough_, options_, work), model.body);
  if (!(other.wrong_by < trial.wrong_by)) return trial;
  model_ = model;
  return other;
}

// The first smooth body that has arrived, or the best of them. Those of long sub-steps come first,
// and of each those whose hands follow the law of the object. They differ in which side valleys
// their fits end in.
SmoothTrial NetFit::FitSmooth() {
  const double most = MostRate(options_, data_.recordings[0]), least = std::min(kSlowRate, most);
  std::optional<SmoothTrial> best;
  const auto is_better = [&](const SmoothTrial& trial) {
    if (!best || trial.HasArrived()) return true;
    const SmoothBody &one = trial.fit.body, &other = best->fit.body;
    const bool costs_more =
        one.most_rate() > other.most_rate() || (one.hands_apart() && !other.hands_apart());
    const double worth = costs_more ? kWorthItsCost : 1;
    return trial.wrong_by < worth * best->wrong_by;
  };
  bool velocity_is_open = HasHands() && !options_.controller_velocity;
  double from = 0;
  for (const Try& one : kTries) {
    const double rate = one.stiff ? most : least;
    if ((one.stiff && most == least) || (one.hands_apart && !HasHands())) continue;
    const bool wants_substeps = best && best->limited;  // hands apart do not help such a body
    if (one.hands_apart && wants_substeps && rate < most) continue;
    const SmoothTrial trial =
        Judge(FitSmoothBody(model_, enough_, options_, {rate, one.hands_apart},
                            work_.Part(one.name, from, one.fitted)),
              model_.body);
    if (is_better(trial)) best = trial;
    if (velocity_is_open && !best->HasArrived() && (!best->limited || rate == most)) {
      best = WithBetterVelocity(*best,
                                work_.Part("controllers' velocity", one.fitted, one.with_velocity));
      velocity_is_open = false;
    }
    from = one.with_velocity;
    if (best->HasArrived()) break;
  }
  if (ParticleFrames(short_, kMostCommonRecordings) <
      ParticleFrames(data_, kMostCommonRecordings)) {
    const Work on_all = work_.Part("smooth body, all frames", kSmoothPart, kAllFramesPart);
    best->fit = FitOn(best->fit, model_, episodes_, options_, on_all);
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
    const double error =
        GeometricTrackError(system, judged, FrameUse::kHeld, FreeMotion(model_.body));
    if (error >= kWorthIt * least) return;
    best = kind;
    least = error;
  };
  const SpringMassSystem tried =
      FitOn(smooth.fit, model_, fit, options_,
            work_.Part("trial, smooth body", kAllFramesPart, kTriedSmooth))
          .System();
  judge(Kind::kSmooth, tried);
  judge(Kind::kStiffnesses,
        FitStiffnesses(tried, model_.body, held_back.fit, options_,
                       work_.Part("trial, stiffnesses", kTriedSmooth, kTriedStiffnesses)));
  if (smooth.correlation >= kNoiseCorrelation) {
    judge(Kind::kSprings,
          FitSpringsOf(model_, held_back.fit, options_,
                       work_.Part("trial, single springs", kTriedStiffnesses, kTried)));
  }
  return best;
}

// The model with common factors that are fitted to all data.
ChosenBody NetFit::WithCommonFactors(const ChosenBody& model, const Work& work) const {
  ChosenBody start = model;
  start.factors = start.start;
  return FitCommonFactors(start, episodes_, options_, kAllGains, work.Part("common factors", 0, 1));
}

// Single springs without a smooth body before, which would have told the treatment of the
// controllers' velocity: common factors tell it.
FittedNet NetFit::FitSpringsAlone() const {
  const bool may_choose = HasHands() && !options_.controller_velocity;
  const double compared = may_choose ? 0.05 : 0.1, common = 0.1;
  ChosenBody model = WithCommonFactors(model_, work_.Stretch("one", 0, compared));
  if (may_choose) {
    const ChosenBody other =
        WithCommonFactors(WithOtherVelocity(model_), work_.Stretch("other", compared, common));
    if (ErrorOf(other) < ErrorOf(model)) model = other;
  }
  return {FitSpringsOf(model, data_, options_, work_.Part("single springs", common, 1)),
          model.body};
}

FittedNet NetFit::Run() {
  const bool smooth_only = options_.method == TrainOptions::Method::kSmooth;
  if (AsksForSprings(options_)) return FitSpringsAlone();
  const SmoothTrial smooth = FitSmooth();
  const SpringMassSystem system = smooth.fit.System();
  if (smooth_only || smooth.correlation < kSurelyNoise || LeavesOutSingleValues(data_, options_)) {
    return {system, model_.body};
  }
  switch (BestPredictor(smooth)) {
    case Kind::kStiffnesses:
      return {FitStiffnesses(system, model_.body, data_, options_,
                             work_.Part("stiffnesses", kTried, 1)),
              model_.body};
    case Kind::kSprings:
      return {FitSpringsOf(WithCommonFactors(model_, work_.Stretch("all", kTried, kCommon)), data_,
                           options_, work_.Part("single springs", kCommon, 1)),
              model_.body};
    case Kind::kSmooth:
      break;
  }
  return {system, model_.body};
}

}  // namespace

bool LeavesOutSingleValues(const FitData& data, const TrainOptions& options) {
  return options.method == TrainOptions::Method::kFull && !AsksForSprings(options) &&
         ParticleFrames(data, kMostSpringRecordings) > kMostParticleFrames;
}

FittedNet FitNet(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
                 const Work& work) {
  return NetFit(chosen, data, options, work).Run();
}

}  // namespace physpring
