// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/find_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/acceptance.h"
#include "diagnosis/effect_search.h"
#include "diagnosis/trained_fit.h"
#include "trainer/solvers/parallel.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

constexpr int kSpringSteps = 10;  // steps of Gauss-Newton after an effect is found
constexpr int kDraws = 2000;
constexpr double kBlock = 0.2;  // s, a block of the bootstrap

// Parts of the work that are done: in the loop, after the refits without an effect; in a round,
// after the search, after what was chosen is fitted once more, and after single springs are fitted.
// The training takes the rest.
constexpr double kCommonPart = 0.2, kFollowPart = 0.45, kSearchPart = 0.5, kTrainingPart = 0.65;

// What stays the same in all rounds.
struct Inquiry {
  const Fitting& fitting;
  double noise_floor;
  const DiagnosisOptions& options;
  std::vector<const Effect*> effects;  // those that may be missing

  // Whether single springs are refitted, too.
  bool open() const { return !fitting.bodies()[0].trusted; }
  BootstrapResult Gain(const Verdict& without, const Verdict& with) const {
    return GainOf(fitting, options.seed, without.held, with.held);
  }
  PairedErrors Compare(const Verdict& without, const Verdict& with) const {
    return {without.track.held, with.track.held, Gain(without, with)};
  }
  // The threshold for the one that is chosen among so many refits.
  Threshold ThresholdFor(std::size_t tried) const {
    return {noise_floor, options.false_alarm, options.least_gain, options.least_noise,
            static_cast<int>(tried)};
  }
};

// What is known before a round.
struct Standing {
  FittedBodies bodies;       // what effects are added to
  Verdict common, accepted;  // without and with the springs' own parameters
  // The verdict with another effect in the last round, if one was about as good as `common`. What
  // is added next tells which is right.
  std::optional<Verdict> rival;
};

// The search for one more effect.
struct Attempt {
  Standing beside;  // what it is added to
  EffectSearchResult search;
  bool rival_won = false;     // `beside` is the rival of the last round
  std::size_t best = 0;       // an index of search.verdicts
  Verdict with_springs = {};  // the best one with its single springs fitted, where that was done

  bool found() const { return !search.verdicts.empty(); }
  const Verdict& chosen() const { return search.verdicts[best]; }
};

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
    const bool has_it =
        std::any_of(body.effects.begin(), body.effects.end(),
                    [&](const EffectValues& own) { return own.name == effect->name(); });
    if (has_it || !effect->MayBeMissing(traits)) continue;
    if (CanBeJudged(effect->value_count(), in_between)) effects.push_back(effect);
  }
  return effects;
}

std::string NameOf(const Verdict& verdict) { return verdict.descent.hypothesis.NewEffect(); }

Eigen::Index NewParametersOf(const Verdict& verdict) {
  return verdict.descent.hypothesis.NewParameters();
}

// The second verdict only if it predicts the held-out frames better.
Verdict Better(const Verdict& verdict, const Verdict& offered) {
  return offered.track.held < verdict.track.held ? offered : verdict;
}

int BlockOf(const Fitting& fitting) {
  return static_cast<int>(std::ceil(kBlock * fitting.recordings()[0].recording->fps));
}

std::size_t ChooseAmong(const Inquiry& inquiry, const std::vector<Verdict>& verdicts) {
  std::vector<Scored> scored;
  for (const Verdict& v : verdicts) {
    scored.push_back({v.descent.hypothesis.ParameterCount(), v.track.held, v.held});
  }
  return ChooseSimplest(scored, BlockOf(inquiry.fitting), inquiry.options.seed);
}

// The model without a new effect, with those that are known; nothing if it diverges.
std::optional<Standing> FitDeclared(const Fitting& fitting, const std::vector<EffectValues>& known,
                                    const WorkShare& share) {
  FittedBodies bodies = FitBodies(fitting, known, share.Part(0, 0.7));
  const std::vector<Verdict> free = FitFreely(fitting, share.Part(0.7, 1), bodies.fitted);
  if (free.empty()) return {};
  return Standing{std::move(bodies), free[0], free[0], {}};
}

// Searches for one more effect beside those that are accepted, or beside a rival's, which then
// takes their place.
Attempt Search(const Inquiry& inquiry, const Standing& standing, const WorkShare& stage) {
  const auto search = [&](const FittedBodies& bodies, const WorkShare& part) {
    return SearchEffects(inquiry.fitting, bodies, inquiry.effects, part);
  };
  if (!standing.rival) return {standing, search(standing.bodies, stage)};
  Attempt first{standing, search(standing.bodies, stage.Part(0, 0.5))};
  const Verdict& rival = *standing.rival;
  const FittedBodies bodies{{}, {rival.descent}};
  Attempt other{{bodies, rival, rival, {}}, search(bodies, stage.Part(0.5, 1)), true};
  if (!other.found()) return first;
  const std::vector<Verdict>& found = other.search.verdicts;
  const Verdict& best = found[ChooseAmong(inquiry, found)];
  const auto is_better_than = [&](const Verdict& verdict) {
    return IsSurelyBetter(inquiry.Gain(verdict, best));
  };
  const bool better = is_better_than(standing.accepted) &&
                      (!first.found() || is_better_than(first.search.verdicts.front()));
  const Threshold threshold = inquiry.ThresholdFor(found.size());
  if (!better || !IsWorthIt(inquiry.Gain(rival, best), rival.track.held, threshold)) return first;
  return other;
}

// Traces all effects, refits the best few and chooses among them; none where nothing is left to
// explain. What is chosen is fitted once more.
Attempt LookForOneMore(const Inquiry& inquiry, const Standing& standing, int round,
                       const WorkShare& stage) {
  const bool done = NothingIsLeft(round, standing.common.track.held, standing.accepted.track.held,
                                  inquiry.noise_floor);
  Attempt attempt =
      done ? Attempt{standing, {}} : Search(inquiry, standing, stage.Part(0, kFollowPart));
  if (!attempt.found()) return attempt;
  attempt.best = ChooseAmong(inquiry, attempt.search.verdicts);
  Verdict& chosen = attempt.search.verdicts[attempt.best];
  if (chosen.track.held > kExplained * inquiry.noise_floor) {
    const WorkShare share = stage.Part(kFollowPart, kSearchPart);
    // what it is compared with comes first: what that gains is no merit of the effect
    Standing& beside = attempt.beside;
    beside.common = FollowAgain(inquiry.fitting, share.Part(0, 0.5), beside.common);
    if (round == 0) beside.accepted = Better(beside.accepted, beside.common);
    chosen = FollowAgain(inquiry.fitting, share.Part(0.5, 1), chosen);
  }
  return attempt;
}

// The attempt with single springs fitted: those of what was chosen and, in the first round, those
// of the model without it, at the same time.
Attempt FitSprings(const Inquiry& inquiry, Attempt attempt, int round, const WorkShare& stage) {
  Standing& beside = attempt.beside;
  if (attempt.found()) attempt.with_springs = attempt.chosen();
  std::vector<Verdict*> refitted;
  if (round == 0 && beside.accepted.provenance != Verdict::Provenance::kTraining) {
    refitted.push_back(&beside.accepted);
  }
  // single springs that are not needed predict other motions worse
  if (attempt.found() && !IsExplained(attempt.chosen().track.held, inquiry.noise_floor)) {
    refitted.push_back(&attempt.with_springs);
  }
  if (inquiry.open()) {
    const int count = static_cast<int>(refitted.size());
    inquiry.fitting.journal().Stage(stage, count * kSpringSteps, "refitting single springs");
    ParallelFor(count, inquiry.options.threads, [&](int i) {
      Verdict& verdict = *refitted[static_cast<std::size_t>(i)];
      verdict = inquiry.fitting.RefitSprings(kSpringSteps, verdict);
    });
  }
  if (round == 0) beside.accepted = Better(beside.accepted, beside.common);
  if (!attempt.found()) return attempt;
  if (!IsSurelyBetter(inquiry.Gain(attempt.chosen(), attempt.with_springs))) {
    attempt.with_springs = attempt.chosen();
  }
  return attempt;
}

// The parameters of the effect that was found that are at a bound, "KEY (value)", in words. What
// ends there stands for something else. Values along the body, or over time, are judged as a whole.
std::string AtBounds(const EffectValues& effect) {
  std::string keys;
  Eigen::Index i = 0;
  for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
    for (int k = 0; k < parameter.count; ++k, ++i) {
      if (parameter.count > 1 || !IsAtBound(parameter, effect.values[i])) continue;
      keys +=
          fmt::format("{}{} ({:.3g})", keys.empty() ? "" : ", ", parameter.key, effect.values[i]);
    }
  }
  return keys;
}

// Why the effect that was found is not accepted, "NAME: ..."; empty if it is.
std::string Refusal(const Inquiry& inquiry, const Attempt& attempt) {
  const PairedErrors common = inquiry.Compare(attempt.beside.common, attempt.chosen());
  const PairedErrors springs = inquiry.Compare(attempt.beside.accepted, attempt.with_springs);
  const Threshold threshold = inquiry.ThresholdFor(attempt.search.verdicts.size());
  const std::string name = NameOf(attempt.chosen());
  if (!IsAccepted(common, springs, NewParametersOf(attempt.chosen()), threshold)) {
    return name + ": " + WhyNotAccepted(common, springs, threshold);
  }
  const std::string bounds = AtBounds(attempt.chosen().system.effects.back());
  if (bounds.empty()) return "";
  return fmt::format("{}: ends at the bound of {}, so it stands for something else", name, bounds);
}

// The best other effect of the search, if it is near the one that is accepted.
std::optional<Verdict> RivalOf(const Inquiry& inquiry, const Attempt& attempt) {
  const Verdict& common = attempt.beside.common;
  const std::vector<Verdict>& verdicts = attempt.search.verdicts;  // best first
  const auto rival = std::find_if(verdicts.begin(), verdicts.end(), [&](const Verdict& verdict) {
    return &verdict != &attempt.chosen() && !IsFreeForm(NewParametersOf(verdict)) &&
           AtBounds(verdict.system.effects.back()).empty() &&
           IsNear(verdict.track.held, attempt.chosen().track.held);
  });
  if (rival == verdicts.end()) return {};
  const Threshold threshold = inquiry.ThresholdFor(verdicts.size());
  if (!IsWorthIt(inquiry.Gain(common, *rival), common.track.held, threshold)) return {};
  return *rival;
}

// The standing with the effect. Where that leaves something to explain, it is taken from a training
// if that is better.
Standing Accept(const Inquiry& inquiry, const Attempt& attempt, const WorkShare& stage) {
  const Verdict& chosen = attempt.chosen();
  Standing standing{
      {{}, {chosen.descent}}, chosen, attempt.with_springs, RivalOf(inquiry, attempt)};
  const bool explained = IsExplained(chosen.track.held, inquiry.noise_floor);
  if (!inquiry.open() || !inquiry.options.train_anew || explained) return standing;
  const auto anew = TrainAnew(inquiry.fitting, stage, standing.accepted.system.effects);
  if (anew && IsSurelyBetter(inquiry.Gain(standing.accepted, *anew))) standing.accepted = *anew;
  return standing;
}

EffectRanking Rank(const Inquiry& inquiry, const Attempt& attempt) {
  EffectRanking candidates;
  for (const EffectTrace& trace : attempt.search.traces) {
    EffectCandidate candidate;
    candidate.name = trace.effect->name();
    candidate.score = trace.score;
    for (const Verdict& verdict : attempt.search.verdicts) {
      if (NameOf(verdict) != candidate.name) continue;
      candidate.refit = verdict.track;
      candidate.without = attempt.beside.common.track.held;
      candidate.gain = inquiry.Gain(attempt.beside.common, verdict);
      candidate.values = verdict.system.effects.back();
      candidate.alike = IsAlike(inquiry.Gain(verdict, attempt.chosen()));
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

// The ranking in which `name` is not alike any more, once the next effect has told it from another.
EffectRanking WithoutAlike(EffectRanking ranking, const std::string& name) {
  for (EffectCandidate& candidate : ranking) {
    if (candidate.name == name) candidate.alike = false;
  }
  return ranking;
}

// A round's share: half of what is left after the round before, since few diagnoses need all
// rounds.
WorkShare ShareOf(const WorkShare& rounds, int round, int most_rounds) {
  const double left = std::pow(0.5, round);
  return rounds.Part(1 - left, round + 1 == most_rounds ? 1 : 1 - left / 2);
}

}  // namespace

std::optional<Findings> FindEffects(const Fitting& fitting, double noise_floor,
                                    const DiagnosisOptions& options, const WorkShare& share,
                                    const std::vector<EffectValues>& known,
                                    const std::optional<Verdict>& trained) {
  const Inquiry inquiry{fitting, noise_floor, options,
                        EffectsFor(fitting.recordings(), fitting.bodies()[0].base)};
  const auto declared = FitDeclared(fitting, known, share.Part(0, kCommonPart));
  if (!declared) return {};
  Standing standing = *declared;
  if (trained) standing.accepted = Better(standing.accepted, *trained);
  Findings findings;
  for (int round = 0; round < options.most_effects; ++round) {
    const WorkShare stage = ShareOf(share.Part(kCommonPart, 1), round, options.most_effects);
    Attempt attempt = LookForOneMore(inquiry, standing, round, stage);
    if (attempt.rival_won) {
      findings.rankings.back() = WithoutAlike(findings.rankings.back(), NameOf(standing.common));
    }
    findings.rankings.push_back(Rank(inquiry, attempt));
    attempt = FitSprings(inquiry, attempt, round, stage.Part(kSearchPart, kTrainingPart));
    if (round == 0) findings.before = attempt.beside.accepted;
    standing = attempt.beside;
    if (attempt.found()) findings.refusal = Refusal(inquiry, attempt);
    if (!attempt.found() || !findings.refusal.empty()) break;
    standing = Accept(inquiry, attempt, stage.Part(kTrainingPart, 1));
  }
  findings.common = standing.common;
  findings.accepted = standing.accepted;
  return findings;
}

BootstrapResult GainOf(const Fitting& fitting, std::uint64_t seed, const FrameTrack& without,
                       const FrameTrack& with) {
  return BlockBootstrap(Difference(without, with), BlockOf(fitting), kDraws, seed);
}

}  // namespace physpring
