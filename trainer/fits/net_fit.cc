// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/net_fit.h"

#include <algorithm>
#include <vector>

#include "trainer/data/held_back.h"
#include "trainer/fits/factor_fit.h"
#include "trainer/fits/smooth_choice.h"
#include "trainer/fits/smooth_fit.h"
#include "trainer/fits/smooth_refinement.h"
#include "trainer/fits/spring_fit.h"
#include "trainer/motion/residual_correlation.h"
#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

// For more particles in frames (held_back.h), few smooth bodies are tried, and no single values.
constexpr double kMostParticleFrames = 1e5;
constexpr int kMostCommonRecordings = 4;  // smooth bodies are fitted to no more than these
constexpr GainSchedule kAllGains{0, 6};
constexpr double kWorthIt = 0.95;  // bodies of more numbers must lower the error to this share

// Parts of the work, as measured on recordings of 80 to 500 particles.
constexpr double kSmoothPart = 0.28, kRefined = 0.32, kAllFramesPart = 0.35, kTriedSmooth = 0.4,
                 kTriedStiffnesses = 0.45, kTried = 0.6, kCommon = 0.65, kGoneOn = 0.9;

bool HasManyParticles(const FitData& data) {
  return ParticleFrames(data, kMostSpringRecordings) > kMostParticleFrames;
}

enum class Kind { kSmooth, kStiffnesses, kSprings };

// A kind of body, and one of it that was fitted to a part of the data.
struct Tried {
  Kind kind;
  SpringMassSystem system;
};

class NetFit {
 public:
  NetFit(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
         const Work& work)
      : model_(chosen),
        data_(data),
        options_(options),
        work_(work),
        episodes_(FitEpisodes(data, kMostCommonRecordings)) {}

  FittedNet Run();

 private:
  bool HasHands() const { return data_.recordings[0].controller_count() > 0; }
  RolloutOptions FreeMotion(const Body& body) const {
    return FollowOptions(data_.recordings[0], body, options_).rollout;
  }
  double ErrorOf(const SpringMassSystem& system, const Body& body) const {
    return GeometricTrackError(system, episodes_, FrameUse::kFit, FreeMotion(body));
  }
  double ErrorOf(const ChosenBody& model) const {
    return ErrorOf(model.System(data_.recordings[0]), model.body);
  }
  SmoothlyChosen FitSmooth();
  Tried BestPredictor(const SmoothlyChosen& smooth) const;
  SpringMassSystem FitAll(const Tried& tried, const SpringMassSystem& smooth) const;
  ChosenBody WithCommonFactors(const ChosenBody& model, const Work& work) const;
  FittedNet FitSpringsAlone() const;

  ChosenBody model_;
  const FitData& data_;
  TrainOptions options_;
  const Work& work_;
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

// The best smooth body. It is chosen by no more frames than tell, and fitted to all.
SmoothlyChosen NetFit::FitSmooth() {
  const FitData some = ShortMotions(data_, kMostCommonRecordings);
  const std::vector<Episode> episodes = FitEpisodes(some, kMostCommonRecordings);
  SmoothlyChosen smooth = ChooseSmoothBody(model_, episodes, options_, HasManyParticles(data_),
                                           work_.Stretch("smooth", 0, kSmoothPart));
  smooth = Refine(smooth, episodes, options_, work_.Stretch("refined", kSmoothPart, kRefined));
  model_ = smooth.model;
  options_.substeps = smooth.substeps;
  if (ParticleFrames(some, kMostCommonRecordings) < ParticleFrames(data_, kMostCommonRecordings)) {
    smooth.fit = FitToTheEnd(smooth.fit, model_, episodes_, options_,
                             work_.Part("smooth body, all frames", kRefined, kAllFramesPart));
  }
  return smooth;
}

// What predicts best what is held back; of bodies that predict about as well, the one of the fewest
// numbers.
Tried NetFit::BestPredictor(const SmoothlyChosen& smooth) const {
  const HeldBackMotion held_back = HoldBackMotion(data_, kMostCommonRecordings);
  const std::vector<Episode> judged = held_back.JudgedEpisodes();
  const std::vector<Episode> fit = FitEpisodes(held_back.fit, kMostCommonRecordings);
  Tried best{Kind::kSmooth, {}};
  double least = kInfinity;
  const auto judge = [&](Kind kind, const SpringMassSystem& system) {
    const double error =
        GeometricTrackError(system, judged, FrameUse::kHeld, FreeMotion(model_.body));
    if (error >= kWorthIt * least) return;
    best = {kind, system};
    least = error;
  };
  const SpringMassSystem tried =
      FitToTheEnd(smooth.fit, model_, fit, options_,
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
        WithCommonFactors(model_.WithOtherVelocity(), work_.Stretch("other", compared, common));
    if (ErrorOf(other) < ErrorOf(model)) model = other;
  }
  return {FitSpringsOf(model, data_, options_, work_.Part("single springs", common, 1)), model.body,
          options_.substeps};
}

// A body of the kind that predicts best, fitted to all data. From common factors on it may get lost
// where it was not when it was tried: it then goes on from there. A body that has more numbers than
// the smooth one and fits worse did not arrive, and is not taken.
SpringMassSystem NetFit::FitAll(const Tried& tried, const SpringMassSystem& smooth) const {
  const Recording& first = data_.recordings[0];
  const double bound = ErrorOf(smooth, model_.body);
  const auto arrived = [&](const SpringMassSystem& one) {
    return ErrorOf(one, model_.body) <= bound;
  };
  if (tried.kind == Kind::kStiffnesses) {
    const SpringMassSystem own =
        FitStiffnesses(smooth, model_.body, data_, options_, work_.Part("stiffnesses", kTried, 1));
    return arrived(own) ? own : smooth;
  }
  SpringMassSystem own =
      FitSpringsOf(WithCommonFactors(model_, work_.Stretch("all", kTried, kCommon)), data_,
                   options_, work_.Part("single springs", kCommon, kGoneOn));
  if (arrived(own)) return own;
  const SpringMassSystem gone_on =
      WithOwnValues(SpringFactors(tried.system, first, *model_.body.kind), model_.body, data_,
                    options_, work_.Part("single springs, from the trial", kGoneOn, 1));
  return arrived(gone_on) ? gone_on : smooth;
}

FittedNet NetFit::Run() {
  const bool smooth_only = options_.method == TrainOptions::Method::kSmooth;
  if (AsksForSprings(options_)) return FitSpringsAlone();
  const SmoothlyChosen smooth = FitSmooth();
  const SpringMassSystem system = smooth.fit.System();
  if (smooth_only || smooth.correlation < kSurelyNoise || LeavesOutSingleValues(data_, options_)) {
    return {system, model_.body, options_.substeps};
  }
  const Tried best = BestPredictor(smooth);
  if (best.kind == Kind::kSmooth) return {system, model_.body, options_.substeps};
  return {FitAll(best, system), model_.body, options_.substeps};
}

}  // namespace

bool LeavesOutSingleValues(const FitData& data, const TrainOptions& options) {
  return options.method == TrainOptions::Method::kFull && !AsksForSprings(options) &&
         HasManyParticles(data);
}

FittedNet FitNet(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
                 const Work& work) {
  return NetFit(chosen, data, options, work).Run();
}

}  // namespace physpring
