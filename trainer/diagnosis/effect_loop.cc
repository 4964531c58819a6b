// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trainer/diagnosis/trained_fit.h"
#include "trainer/parallel.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

constexpr int kSpringSteps = 10;  // of Gauss-Newton, after an effect is found
constexpr int kDraws = 2000;
constexpr double kBlock = 0.2;  // s, of the bootstrap
// Held-out errors, times the noise floor: below kExplained single springs would bend to the noise;
// below this nothing is missing besides the effects that were found.
constexpr double kExplainedByEffects = 2;

// Part of the error above the noise that an effect must explain with common factors alone, where
// single springs could do without it.
constexpr double kSimplyExplained = 0.8;

// A rival's error of held-out frames, times that of the fit that was chosen.
constexpr double kRival = 1.25;

// Shares of the loop: refits without an effect; and of a round the search, with the springs' refit,
// and the training.
constexpr double kCommonPart = 0.2, kFollowPart = 0.45, kSearchPart = 0.5, kTrainingPart = 0.65;

// Whether frames to judge by lie between frames to fit.
bool IsJudgedInBetween(const SplitRecording& split) {
  const auto held = std::find(split.use.begin(), split.use.end(), SplitRecording::Use::kHeld);
  return std::find(held, split.use.end(), SplitRecording::Use::kFit) != split.use.end();
}

std::vector<const Effect*> EffectsFor(const std::vector<SplitRecording>& splits,
                                      const SpringMassSystem& body) {
  const bool ground = splits[0].recording->ground.has_value();
  const BodyTraits traits = {ground, IsSolid(body), body.order.size() > 0};
  const bool in_between = std::any_of(splits.begin(), splits.end(), IsJudgedInBetween);
  std::vector<const Effect*> effects;
  for (const Effect* effect : AllEffects()) {
    if (!effect->MayBeMissing(traits)) continue;
    const bool has_it =
        std::any_of(body.effects.begin(), body.effects.end(),
                    [&](const EffectValues& own) { return own.name == effect->name(); });
    if (has_it) continue;
    if (in_between && HasFreeForm(*effect)) continue;  // it would be judged by interpolation
    effects.push_back(effect);
  }
  return effects;
}

}  // namespace

EffectLoop::EffectLoop(const EffectFitting& fitting, double noise_floor,
                       const DiagnosisOptions& options, const WorkShare& share)
    : fitting_(fitting),
      noise_floor_(noise_floor),
      open_(!fitting.bodies()[0].trusted),
      options_(options),
      common_share_(share.Part(0, kCommonPart)),
      rounds_share_(share.Part(kCommonPart, 1)),
      effects_(EffectsFor(fitting.recordings(), fitting.bodies()[0].base)),
      block_(static_cast<int>(std::ceil(kBlock * fitting.recordings()[0].recording->fps))) {}

bool EffectLoop::FitCommon(const std::vector<EffectValues>& known) {
  bodies_ = FitBodies(fitting_, known, common_share_.Part(0, 0.7));
  std::vector<EffectFit> free = bodies_.fitted;
  FitFreely(fitting_, common_share_.Part(0.7, 1), &free);
  if (free.empty()) return false;
  common_ = accepted_ = free[0];
  return true;
}

void EffectLoop::Offer(const EffectFit& fit) {
  if (fit.track.held < accepted_.track.held) accepted_ = fit;
}

bool EffectLoop::Round(int round) {
  const WorkShare stage = ShareOf(round);
  EffectSearchResult search;
  if (!IsExplained(round)) search = Search(stage.Part(0, kFollowPart));
  const bool found = !search.fits.empty();
  const std::size_t best = found ? ChooseSimplest(search.fits, block_, options_.seed) : 0;
  if (found && search.fits[best].track.held > kExplained * noise_floor_) {
    const WorkShare share = stage.Part(kFollowPart, kSearchPart);
    // first what it is compared with: what that gains is no merit of the effect
    FollowAgain(fitting_, share.Part(0, 0.5), &common_);
    if (round == 0) Offer(common_);
    FollowAgain(fitting_, share.Part(0.5, 1), &search.fits[best]);
  }
  rankings_.push_back(Rank(search, best));
  const EffectFit chosen = found ? search.fits[best] : common_;
  // single springs that are not needed predict other motions worse
  const bool explained = chosen.track.held < kExplained * noise_floor_;
  EffectFit with_springs = chosen;
  std::vector<EffectFit*> refitted;
  if (round == 0 && !accepted_.trained) refitted.push_back(&accepted_);
  if (found && !explained) refitted.push_back(&with_springs);
  RefitSprings(stage.Part(kSearchPart, kTrainingPart), refitted);
  if (round == 0) {
    Offer(common_);
    before_ = accepted_;
  }
  if (!found || chosen.track.held >= common_.track.held) return false;
  if (!IsSurelyBetter(with_springs, chosen)) with_springs = chosen;
  const auto tried = static_cast<int>(search.fits.size());
  // hundreds of springs may bend to what a few parameters explain
  const bool without_springs =
      !IsFreeForm(chosen) && IsWorthIt(common_, chosen, kSimplyExplained, tried) &&
      with_springs.track.held < accepted_.track.held + options_.least_noise * noise_floor_;
  if (!without_springs && !IsWorthIt(accepted_, with_springs, options_.least_gain, tried)) {
    return false;
  }
  FindRival(search, best);
  accepted_ = std::move(with_springs);
  common_ = chosen;
  bodies_ = {{}, {chosen}};
  if (!open_ || !options_.train_anew || explained) return true;
  const auto anew = TrainAnew(fitting_, stage.Part(kTrainingPart, 1), accepted_);
  if (anew && IsSurelyBetter(*anew, accepted_)) accepted_ = *anew;
  return true;
}

BootstrapResult EffectLoop::Gain(const FrameTrack& without, const FrameTrack& with) const {
  return BlockBootstrap(Difference(without, with), block_, kDraws, options_.seed);
}

// Half of what is left after the round before, since few diagnoses need all rounds.
WorkShare EffectLoop::ShareOf(int round) const {
  const double left = std::pow(0.5, round);
  return rounds_share_.Part(1 - left, round + 1 == options_.most_effects ? 1 : 1 - left / 2);
}

bool EffectLoop::IsExplained(int round) const {
  return round == 0 ? common_.track.held < kExplained * noise_floor_
                    : accepted_.track.held < kExplainedByEffects * noise_floor_;
}

// For one more effect, beside those that are accepted or beside a rival's, which then takes their
// place.
EffectSearchResult EffectLoop::Search(const WorkShare& stage) {
  if (!rival_) return SearchEffects(fitting_, bodies_, effects_, stage);
  EffectSearchResult search = SearchEffects(fitting_, bodies_, effects_, stage.Part(0, 0.5));
  const EffectFit rival = *std::exchange(rival_, std::nullopt);
  const FittedBodies bodies{{}, {rival}};
  EffectSearchResult other = SearchEffects(fitting_, bodies, effects_, stage.Part(0.5, 1));
  if (other.fits.empty()) return search;
  const EffectFit& best = other.fits[ChooseSimplest(other.fits, block_, options_.seed)];
  const bool better = IsSurelyBetter(best, accepted_) &&
                      (search.fits.empty() || IsSurelyBetter(best, search.fits.front()));
  const auto tried = static_cast<int>(other.fits.size());
  if (!better || !IsWorthIt(rival, best, options_.least_gain, tried)) return search;
  for (EffectCandidate& candidate : rankings_.back()) {
    if (candidate.name == common_.start.back().name) candidate.alike = false;
  }
  accepted_ = common_ = rival;
  bodies_ = bodies;
  return other;
}

// The best other effect of a search, beside the chosen one that is about to be accepted.
void EffectLoop::FindRival(const EffectSearchResult& search, std::size_t chosen) {
  const auto tried = static_cast<int>(search.fits.size());
  rival_.reset();
  for (const EffectFit& fit : search.fits) {  // best first
    const bool other = &fit != &search.fits[chosen];
    const bool near = fit.track.held < kRival * search.fits[chosen].track.held;
    if (!other || !near || IsFreeForm(fit)) continue;
    if (IsWorthIt(common_, fit, options_.least_gain, tried)) rival_ = fit;
    return;
  }
}

// Many parameters must be better than few by more than a standard error.
bool EffectLoop::IsSurelyBetter(const EffectFit& many, const EffectFit& few) const {
  const BootstrapResult gain = Gain(few.held, many.held);
  return gain.mean > gain.error;
}

// Whether the effect takes away a part `least_gain` of the error above the noise. `tried`: refits
// among which it was chosen.
bool EffectLoop::IsWorthIt(const EffectFit& without, const EffectFit& with, double least_gain,
                           int tried) const {
  const BootstrapResult gain = Gain(without.held, with.held);
  const double excess = std::max(0.0, without.track.held - noise_floor_);
  return gain.p < options_.false_alarm / tried && gain.mean > least_gain * excess &&
         gain.mean > options_.least_noise * noise_floor_;
}

EffectRanking EffectLoop::Rank(const EffectSearchResult& search, std::size_t chosen) const {
  EffectRanking candidates;
  for (const EffectTrace& trace : search.traces) {
    EffectCandidate candidate{trace.effect->name(), trace.score, {}, {}, {}, false};
    for (const EffectFit& fit : search.fits) {
      if (fit.start.back().name != candidate.name) continue;
      candidate.refit = fit.track;
      candidate.gain = Gain(common_.held, fit.held);
      candidate.values = fit.system.effects.back();
      const BootstrapResult worse = Gain(fit.held, search.fits[chosen].held);
      candidate.alike = worse.mean <= worse.error;
    }
    candidates.push_back(std::move(candidate));
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const EffectCandidate& p, const EffectCandidate& q) {
                     const bool p_fits = p.refit.has_value(), q_fits = q.refit.has_value();
                     if (p_fits != q_fits) return p_fits;
                     return p_fits ? p.refit->held < q.refit->held : p.score > q.score;
                   });
  return candidates;
}

// Single springs, too, of all these at the same time.
void EffectLoop::RefitSprings(const WorkShare& stage, const std::vector<EffectFit*>& fits) const {
  if (!open_) return;
  const int count = static_cast<int>(fits.size());
  fitting_.journal().Stage(stage, count * kSpringSteps, "refitting single springs");
  ParallelFor(count, options_.threads, [&](int i) {
    fitting_.RefitSprings(kSpringSteps, fits[static_cast<std::size_t>(i)]);
  });
}

}  // namespace physpring
