// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "trainer/diagnosis/effect_search.h"
#include "trainer/diagnosis/noise_floor.h"
#include "trainer/diagnosis/trained_fit.h"
#include "trainer/parallel.h"
#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/predict.h"
#include "twin/stability.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr int kSpringSteps = 10;  // of Gauss-Newton, after an effect is found
constexpr int kDraws = 2000;
constexpr double kBlock = 0.2;  // s, of the bootstrap
// Held-out errors, times the noise floor: below the first, nothing is missing; below the second,
// nothing besides the effects that were found; above the third, something is.
constexpr double kExplained = 1.25, kExplainedByEffects = 2, kUnexplained = 2.5;

// Part of the error above the noise that an effect must explain with common factors alone, where
// single springs could do without it.
constexpr double kSimplyExplained = 0.8;

// Shares of the work, as the journal tells it: refits without an effect, then rounds, and of a
// round the search, with the springs' refit, and the training.
constexpr WorkShare kCommonShare{0, 0.2};
constexpr double kSearchPart = 0.5, kTrainingPart = 0.65;

bool TrainedOnThis(const Twin& twin, const Recording& recording) {
  return std::any_of(twin.trained_on.begin(), twin.trained_on.end(), [&](const TrainedOn& trained) {
    return !trained.hash.empty() && trained.hash == recording.hash;
  });
}

std::vector<SplitRecording> SplitAll(const std::vector<Recording>& recordings,
                                     const std::vector<Recording>& held_out) {
  std::vector<SplitRecording> splits;
  for (const Recording& recording : recordings) {
    splits.push_back(held_out.empty() ? HoldOutFrames(recording) : UseAll(recording, Use::kFit));
  }
  for (const Recording& recording : held_out) splits.push_back(UseAll(recording, Use::kHeld));
  return splits;
}

double NoiseFloor(const std::vector<SplitRecording>& splits) {
  std::vector<const Recording*> all;
  for (const SplitRecording& split : splits) all.push_back(split.recording);
  return TrackNoiseFloor(MeasurementNoise(all));
}

std::vector<const Effect*> EffectsFor(const Recording& recording, const SpringMassSystem& body) {
  const bool solid = IsSolid(body);
  std::vector<const Effect*> effects;
  for (const Effect* effect : AllEffects()) {
    if (effect->name() == "ground_contact" && !recording.ground) continue;
    if (solid && effect->bends()) continue;
    effects.push_back(effect);
  }
  return effects;
}

// All effects: those refitted first, by their error, then the others, by their trace.
std::vector<EffectCandidate> RankEffects(const EffectSearchResult& search, const EffectFit& without,
                                         std::size_t chosen, int block, std::uint64_t seed) {
  std::vector<EffectCandidate> candidates;
  for (const EffectTrace& trace : search.traces) {
    EffectCandidate candidate{trace.effect->name(), trace.score, {}, {}, {}, false};
    for (const EffectFit& fit : search.fits) {
      if (fit.start.back().name != candidate.name) continue;
      candidate.refit = fit.track;
      candidate.gain = BlockBootstrap(Difference(without.held, fit.held), block, kDraws, seed);
      candidate.values = fit.system.effects.back();
      const BootstrapResult worse =
          BlockBootstrap(Difference(fit.held, search.fits[chosen].held), block, kDraws, seed);
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

// The loop over effects.
class Loop {
 public:
  Loop(const EffectFitting& fitting, double noise_floor, bool trained_on,
       const DiagnosisOptions& options)
      : fitting_(fitting),
        noise_floor_(noise_floor),
        trained_on_(trained_on),
        options_(options),
        effects_(EffectsFor(*fitting.recordings()[0].recording, fitting.bodies()[0].base)),
        block_(static_cast<int>(std::ceil(kBlock * fitting.recordings()[0].recording->fps))) {}

  int block() const { return block_; }
  // Without any new effect, and with those that were accepted.
  const EffectFit& before() const { return before_; }
  const EffectFit& accepted() const { return accepted_; }
  // The same without the springs' own parameters.
  const EffectFit& common() const { return common_; }
  const std::vector<EffectCandidate>& candidates() const { return candidates_; }

  // The refit of common factors without a new effect; false if the model diverges.
  bool FitCommon(const std::vector<EffectValues>& known) {
    bodies_ = FitBodies(fitting_, known, kCommonShare.Part(0, 0.7));
    std::vector<EffectFit> free = bodies_.fitted;
    FitFreely(fitting_, kCommonShare.Part(0.7, 1), &free);
    if (free.empty()) return false;
    common_ = accepted_ = free[0];
    return true;
  }

  // A fit without a new effect from elsewhere: taken if it predicts the held-out frames better.
  void Offer(const EffectFit& fit) {
    if (fit.track.held < accepted_.track.held) accepted_ = fit;
  }

  // Looks for one more effect; false if none is accepted.
  bool Round(int round) {
    const WorkShare stage = ShareOf(round);
    EffectSearchResult search;
    if (!IsExplained(round)) {
      search = SearchEffects(fitting_, bodies_, effects_, stage.Part(0, kSearchPart));
    }
    const bool found = !search.fits.empty();
    const std::size_t best = found ? ChooseSimplest(search.fits, block_, options_.seed) : 0;
    if (round == 0) candidates_ = RankEffects(search, common_, best, block_, options_.seed);
    const EffectFit chosen = found ? search.fits[best] : common_;
    EffectFit with_springs = chosen;
    std::vector<EffectFit*> refitted;
    if (round == 0 && !accepted_.trained) refitted.push_back(&accepted_);
    if (found) refitted.push_back(&with_springs);
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
        IsWorthIt(common_, chosen, kSimplyExplained, tried) &&
        with_springs.track.held < accepted_.track.held + options_.least_noise * noise_floor_;
    if (!without_springs && !IsWorthIt(accepted_, with_springs, options_.least_gain, tried)) {
      return false;
    }
    accepted_ = std::move(with_springs);
    common_ = chosen;
    bodies_ = {{}, {chosen}};
    if (!trained_on_ || !options_.train_anew) return true;
    const auto anew = TrainAnew(fitting_, stage.Part(kTrainingPart, 1), accepted_);
    if (anew && IsSurelyBetter(*anew, accepted_)) accepted_ = *anew;
    return true;
  }

 private:
  // Half of what is left after the round before, since few diagnoses need all rounds.
  WorkShare ShareOf(int round) const {
    const double left = (1 - kCommonShare.last) * std::pow(0.5, round);
    return {1 - left, round + 1 == options_.most_effects ? 1 : 1 - left / 2};
  }

  bool IsExplained(int round) const {
    return round == 0 ? common_.track.held < kExplained * noise_floor_
                      : accepted_.track.held < kExplainedByEffects * noise_floor_;
  }

  // Many parameters must be better than few by more than a standard error.
  bool IsSurelyBetter(const EffectFit& many, const EffectFit& few) const {
    const BootstrapResult gain =
        BlockBootstrap(Difference(few.held, many.held), block_, kDraws, options_.seed);
    return gain.mean > gain.error;
  }

  // Single springs, too, of all these at the same time.
  void RefitSprings(const WorkShare& stage, const std::vector<EffectFit*>& fits) const {
    if (!trained_on_) return;
    const int count = static_cast<int>(fits.size());
    fitting_.journal().Stage(stage, count * kSpringSteps, "refitting single springs");
    ParallelFor(count, options_.threads, [&](int i) {
      fitting_.RefitSprings(kSpringSteps, fits[static_cast<std::size_t>(i)]);
    });
  }

  // Whether the effect takes away a part `least_gain` of the error above the noise. `tried`: refits
  // among which it was chosen.
  bool IsWorthIt(const EffectFit& without, const EffectFit& with, double least_gain,
                 int tried) const {
    const BootstrapResult gain =
        BlockBootstrap(Difference(without.held, with.held), block_, kDraws, options_.seed);
    const double excess = std::max(0.0, without.track.held - noise_floor_);
    return gain.p < options_.false_alarm / tried && gain.mean > least_gain * excess &&
           gain.mean > options_.least_noise * noise_floor_;
  }

  const EffectFitting& fitting_;
  double noise_floor_;
  bool trained_on_;
  DiagnosisOptions options_;
  std::vector<const Effect*> effects_;
  int block_;
  FittedBodies bodies_;          // that effects are added to
  EffectFit common_, accepted_;  // without and with the springs' own parameters
  EffectFit before_;             // accepted_, without any new effect
  std::vector<EffectCandidate> candidates_;
};

// Whether training has seen none of the frames that are held out.
bool HasNotSeenHeldOut(const Twin& twin, const std::vector<Recording>& recordings,
                       const std::vector<Recording>& held_out) {
  if (!held_out.empty()) {
    return std::none_of(held_out.begin(), held_out.end(),
                        [&](const Recording& r) { return TrainedOnThis(twin, r); });
  }
  return std::all_of(recordings.begin(), recordings.end(),
                     [](const Recording& r) { return r.train_frames < r.frame_count(); });
}

std::ptrdiff_t EffectValueCount(const std::vector<EffectValues>& effects) {
  std::ptrdiff_t count = 0;
  for (const EffectValues& effect : effects) count += effect.values.size();
  return count;
}

// The twin with the fit's system at level 0, and the new effects at all levels.
Twin TwinWith(Twin twin, const EffectFit& fit, const std::vector<EffectValues>& effects,
              const std::vector<Recording>& recordings) {
  twin.training_state.clear();
  for (TwinLevel& level : twin.levels) {
    level.system.effects.insert(level.system.effects.end(), effects.begin(), effects.end());
  }
  TwinLevel& dense = twin.levels[0];
  dense.system = fit.system;
  const double fps = recordings[0].fps;
  const int substeps = StableSubsteps(ComputeStabilityBound(dense.system), 1 / fps, kStepSafety);
  dense.substeps_per_second =
      static_cast<int>(std::ceil(std::max(substeps * fps, kLeastDiagnosisRate)));
  twin.controller_velocity = fit.controller_velocity;
  for (const Recording& recording : recordings) {
    if (TrainedOnThis(twin, recording)) continue;
    twin.trained_on.push_back({recording.name, recording.hash, recording.train_frames});
  }
  return twin;
}

}  // namespace

Diagnosis Diagnose(const Twin& twin, const std::vector<Recording>& recordings,
                   const std::vector<Recording>& held_out, const DiagnosisOptions& options) {
  Diagnosis result;
  for (const Recording& recording : recordings) {
    ExpectSameObject(twin, recording);
    result.trained_on |= TrainedOnThis(twin, recording);
  }
  for (const Recording& recording : held_out) ExpectSameObject(twin, recording);
  const std::vector<SplitRecording> splits = SplitAll(recordings, held_out);
  result.noise_floor = NoiseFloor(splits);
  const EffectFitting fitting(BodiesOf(twin, recordings[0], result.trained_on), splits,
                              options.threads, options.journal);
  Loop loop(fitting, result.noise_floor, result.trained_on, options);
  const std::vector<EffectValues>& known = twin.levels[0].system.effects;
  if (!loop.FitCommon(known)) {
    throw Error(fmt::format("recording {}: twin {} diverges, so there is nothing to diagnose",
                            recordings[0].name, twin.name));
  }
  // its training took more care than a refit of springs does
  if (result.trained_on && HasNotSeenHeldOut(twin, recordings, held_out)) {
    if (const auto trained = AsTrained(twin, splits, loop.accepted())) loop.Offer(*trained);
  }
  for (int round = 0; round < options.most_effects && loop.Round(round); ++round) {
  }
  const EffectFit& accepted = loop.accepted();
  result.before = loop.before().track;
  result.before_track = loop.before().held;
  result.candidates = loop.candidates();
  result.after = accepted.track;
  result.after_track = accepted.held;
  result.gain = BlockBootstrap(Difference(result.before_track, result.after_track), loop.block(),
                               kDraws, options.seed);
  result.effects.assign(accepted.system.effects.begin() + static_cast<long>(known.size()),
                        accepted.system.effects.end());
  if (!result.effects.empty()) {
    result.certainty = CertaintyOf(fitting, loop.common());
    result.certainty.erase(result.certainty.begin(),
                           result.certainty.end() - EffectValueCount(result.effects));
  }
  if (accepted.track.held > kUnexplained * result.noise_floor) {
    result.unexplained = FindUnexplained(splits, accepted, result.noise_floor);
  }
  result.twin = TwinWith(twin, accepted, result.effects, recordings);
  return result;
}

}  // namespace physpring
