// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/find_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/acceptance.h"
#include "diagnosis/effect_search.h"
#include "diagnosis/inquiry.h"
#include "diagnosis/law_search.h"
#include "diagnosis/noise_floor.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

// The parts of the work that are done after the refits without an effect, and after all rounds.
constexpr double kDeclaredPart = 0.2, kRoundsPart = 0.9;

// What is known before a round.
struct Standing {
  FittedBodies bodies;  // what effects are added to
  Verdict accepted;     // with the effects that were found
  // The verdict with another effect in the last round, if one was about as good as the accepted
  // one. What is added next tells which is right.
  std::optional<Verdict> rival;
};

// The search for one more effect.
struct Attempt {
  Standing beside;  // what it is added to
  std::vector<EffectTrace> traces;
  std::vector<Verdict> verdicts;  // least held-out error first
  bool rival_won = false;         // `beside` is the rival of the last round
  std::size_t best = 0;           // an index of `verdicts`

  bool found() const { return !verdicts.empty(); }
  const Verdict& chosen() const { return verdicts[best]; }
};

std::string NameOf(const Verdict& verdict) { return verdict.descent.hypothesis.NewEffect(); }

Eigen::Index NewParametersOf(const Verdict& verdict) {
  return verdict.descent.hypothesis.NewParameters();
}

// The second verdict only if there is one and it predicts the held-out frames better.
Verdict Better(const Verdict& verdict, const std::optional<Verdict>& offered) {
  return offered && offered->track.held < verdict.track.held ? *offered : verdict;
}

std::size_t ChooseAmong(const Inquiry& inquiry, const std::vector<Verdict>& verdicts) {
  std::vector<Scored> scored;
  for (const Verdict& v : verdicts) {
    scored.push_back({v.descent.hypothesis.ParameterCount(), v.track.held, v.held});
  }
  return ChooseSimplest(scored, inquiry.noise_floor, inquiry.Block(), inquiry.options.seed);
}

// The model without a new effect, with those that are known; nothing if it diverges. Where the body
// as trained leaves no more than noise, others are not fitted.
std::optional<Standing> FitDeclared(const Fitting& fitting, double noise_floor,
                                    const std::vector<EffectValues>& known,
                                    const WorkShare& share) {
  const std::optional<Descent> trained = FitTrained(fitting, known, share.Part(0, 0.1));
  if (trained && IsNearNoise(TrackNoiseFloor(std::sqrt(trained->misfit)), noise_floor)) {
    const auto free = FitFreely(fitting, share.Part(0.1, 0.2), *trained);
    if (free && IsExplained(free->track.held, noise_floor)) {
      return Standing{{{}, *trained}, *free, {}};
    }
  }
  const auto bodies = FitBodies(fitting, known, trained, share.Part(0.2, 0.5));
  if (!bodies) return {};
  const auto free = FitFreely(fitting, share.Part(0.5, 0.7), bodies->fitted);
  if (!free) return {};
  Standing standing{*bodies, *free, {}};
  const double error = free->track.held;
  if (!IsExplained(error, noise_floor) && IsNearNoise(error, noise_floor)) {
    standing.accepted = Better(*free, Refine(fitting, share.Part(0.7, 1), free->descent));
  }
  return standing;
}

Attempt SearchBeside(const Inquiry& inquiry, const Standing& standing, const WorkShare& stage) {
  EffectSearchResult search =
      SearchEffects(inquiry.fitting, standing.bodies, inquiry.effects, stage);
  Attempt attempt{standing, std::move(search.traces), std::move(search.verdicts)};
  if (attempt.found()) attempt.best = ChooseAmong(inquiry, attempt.verdicts);
  return attempt;
}

// Searches for one more effect beside those that are accepted, or beside a rival's, which then
// takes their place.
Attempt Search(const Inquiry& inquiry, const Standing& standing, const WorkShare& stage) {
  if (!standing.rival) return SearchBeside(inquiry, standing, stage);
  Attempt first = SearchBeside(inquiry, standing, stage.Part(0, 0.5));
  const Verdict& rival = *standing.rival;
  Attempt other = SearchBeside(inquiry, {{{}, rival.descent}, rival, {}}, stage.Part(0.5, 1));
  other.rival_won = true;
  if (!other.found()) return first;
  const Verdict& best = other.chosen();
  const auto is_better_than = [&](const Verdict& verdict) {
    return IsSurelyBetter(inquiry.Gain(verdict, best));
  };
  const bool better = is_better_than(standing.accepted) &&
                      (!first.found() || is_better_than(first.verdicts.front()));
  const Threshold threshold = inquiry.ThresholdFor(other.verdicts.size());
  if (!better || !IsWorthIt(inquiry.Gain(rival, best), rival.track.held, threshold)) return first;
  return other;
}

// Why what was chosen is not worth it, compared with the best fit without it; empty if it is.
std::string WhyNotWorthIt(const Inquiry& inquiry, const Attempt& attempt) {
  const Verdict &without = attempt.beside.accepted, &with = attempt.chosen();
  return WhyNotWorthIt(inquiry.Gain(without, with), without.track.held,
                       inquiry.ThresholdFor(attempt.verdicts.size()));
}

// What was chosen, on the body of the best fit without it; empty if that is a training.
Descent BesideAccepted(const Attempt& attempt) {
  const Descent& accepted = attempt.beside.accepted.descent;
  if (accepted.x.size() == 0) return accepted;
  return accepted.WithNewEffect(attempt.chosen().system.effects.back());
}

// Searches for one more effect, unless nothing is left to explain. What is chosen is fitted once
// more where it leaves more than noise. Then it is left out again, and the body fitted from where
// it is: what another valley gains is no merit of the effect.
Attempt LookForOneMore(const Inquiry& inquiry, const Standing& standing, int round,
                       const WorkShare& stage) {
  constexpr double kFound = 0.8, kChosen = 0.9;
  const Fitting& fitting = inquiry.fitting;
  if (NothingIsLeft(round, standing.accepted.track.held, inquiry.noise_floor)) {
    return {standing, {}, {}};
  }
  Attempt attempt = Search(inquiry, standing, stage.Part(0, kFound));
  if (!attempt.found()) return attempt;
  Verdict& chosen = attempt.verdicts[attempt.best];
  for (const Descent& descent : {chosen.descent, BesideAccepted(attempt)}) {
    if (descent.x.size() == 0 || IsExplained(chosen.track.held, inquiry.noise_floor)) continue;
    const auto refined =
        Refine(fitting, stage.Part(kFound, kChosen), descent, chosen.descent.misfit);
    if (refined && !IsSurelyBetter(inquiry.Gain(*refined, chosen))) chosen = *refined;
  }
  if (!WhyNotWorthIt(inquiry, attempt).empty()) return attempt;
  Verdict& without = attempt.beside.accepted;
  without = Better(without, Refine(fitting, stage.Part(kChosen, 1),
                                   chosen.descent.WithoutNewEffect(), chosen.descent.misfit));
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
  const Verdict &without = attempt.beside.accepted, &with = attempt.chosen();
  const std::string why = WhyNotWorthIt(inquiry, attempt);
  if (!why.empty()) {
    return fmt::format("{}: held out {:.2f} mm without it, {:.2f} mm with it: {}", NameOf(with),
                       1e3 * without.track.held, 1e3 * with.track.held, why);
  }
  const std::string bounds = AtBounds(with.system.effects.back());
  if (bounds.empty()) return "";
  return fmt::format("{}: ends at the bound of {}, so it stands for something else", NameOf(with),
                     bounds);
}

// The best other effect of the search, if it is near the one that is accepted.
std::optional<Verdict> RivalOf(const Inquiry& inquiry, const Attempt& attempt) {
  const Verdict& without = attempt.beside.accepted;
  const std::vector<Verdict>& verdicts = attempt.verdicts;  // best first
  const auto rival = std::find_if(verdicts.begin(), verdicts.end(), [&](const Verdict& verdict) {
    return &verdict != &attempt.chosen() && !IsFreeForm(NewParametersOf(verdict)) &&
           AtBounds(verdict.system.effects.back()).empty() &&
           IsNear(verdict.track.held, attempt.chosen().track.held);
  });
  if (rival == verdicts.end()) return {};
  const Threshold threshold = inquiry.ThresholdFor(attempt.verdicts.size());
  if (!IsWorthIt(inquiry.Gain(without, *rival), without.track.held, threshold)) return {};
  return *rival;
}

EffectRanking Rank(const Inquiry& inquiry, const Attempt& attempt) {
  EffectRanking candidates;
  for (const EffectTrace& trace : attempt.traces) {
    EffectCandidate candidate;
    candidate.name = trace.effect->name();
    candidate.score = trace.score;
    for (const Verdict& verdict : attempt.verdicts) {
      if (NameOf(verdict) != candidate.name) continue;
      candidate.refit = verdict.track;
      candidate.without = attempt.beside.accepted.track.held;
      candidate.gain = inquiry.Gain(attempt.beside.accepted, verdict);
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
  const Inquiry inquiry = InquiryOf(fitting, noise_floor, options);
  const auto declared = FitDeclared(fitting, noise_floor, known, share.Part(0, kDeclaredPart));
  if (!declared) return {};
  Standing standing = *declared;
  standing.accepted = Better(standing.accepted, trained);
  Findings findings;
  for (int round = 0; round < options.most_effects; ++round) {
    const WorkShare stage =
        ShareOf(share.Part(kDeclaredPart, kRoundsPart), round, options.most_effects);
    const Attempt attempt = LookForOneMore(inquiry, standing, round, stage);
    if (attempt.rival_won) {
      findings.rankings.back() = WithoutAlike(findings.rankings.back(), NameOf(standing.accepted));
    }
    findings.rankings.push_back(Rank(inquiry, attempt));
    standing = attempt.beside;
    if (round == 0) findings.before = standing.accepted;
    if (attempt.found()) findings.refusal = Refusal(inquiry, attempt);
    if (!attempt.found() || !findings.refusal.empty()) break;
    const Verdict& chosen = attempt.chosen();
    standing = {{{}, chosen.descent}, chosen, RivalOf(inquiry, attempt)};
  }
  findings.accepted = standing.accepted;
  if (IsUnexplained(standing.accepted.track.held, noise_floor)) {
    const bool refitted = standing.accepted.descent.x.size() > 0;
    const Descent& from = refitted ? standing.accepted.descent : standing.bodies.fitted;
    const auto law = FindLaw(inquiry, standing.accepted, from, share.Part(kRoundsPart, 1));
    if (law) findings.accepted = law->verdict;
    if (law) findings.law_terms = law->terms;
  }
  findings.gain = inquiry.Gain(findings.before, findings.accepted);
  return findings;
}

}  // namespace physpring
