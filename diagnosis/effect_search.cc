// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_search.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "diagnosis/acceptance.h"
#include "diagnosis/halving.h"

namespace physpring {
namespace {

constexpr std::size_t kTracedEffects = 6;  // no more than these are tried on fitted bodies
constexpr double kEarlyTraceGain = 0.2, kTraceGain = 0.1;
constexpr std::size_t kMostStrong = 6;
constexpr char kWithoutEffect[] = " without any new effect", kWithLaw[] = " with another law";

// In this order: bodies under the highest gain; the best ones as smooth bodies down to the gain of
// the trace; the trained one down to that; the best one down to none; laws, strong ones on all
// bodies, and all effects from the start on; all effects with smooth bodies; one fit once more.
constexpr std::array<Cut, 1> kEarlyBodyCuts = {{{0.5, 5, 2, 2}}};
constexpr std::array<Cut, 3> kBodyCuts = {{{0.5, 4, 1, 1}, {0.2, 4, 1, 1}, {0.1, 5, 1, 1}}};
constexpr std::array<Cut, 2> kTrainedCuts = {{{0.2, 4, 1, 1}, {0.1, 5, 1, 1}}};
constexpr std::array<Cut, 1> kFreeCuts = {{{0, 15, 1, 1}}};
constexpr std::array<Cut, 1> kLawCuts = {{{0.5, 2, 12, 4}}};
constexpr std::array<Cut, 3> kStrongCuts = {{{0.5, 2, 8, 6}, {0.5, 2, 6, 4}, {0.5, 4, 4, 3}}};
constexpr Cut kBestLaws = {0.5, 0, 4, 1}, kBestStrong = {0.5, 0, 4, 2};
constexpr std::array<Cut, 1> kEarlyCuts = {{{0.2, 4, 8, 2}}};
constexpr std::array<Cut, 3> kCuts = {{{0.2, 2, 8, 2}, {0.1, 3, 5, 1}, {0, 15, 5, 1}}};
constexpr std::array<Cut, 4> kAgainCuts = {
    {{0.2, 3, 1, 1}, {0.1, 3, 1, 1}, {0, 12, 1, 1}, {0, 12, 1, 1, Fitting::Care::kExact}}};

using Kind = DiagnosisBody::Kind;

Kind KindOf(const Fitting& fitting, std::size_t body) { return fitting.bodies()[body].kind; }

// The fits with smooth bodies; those of bodies that hardly move as they are.
std::vector<Descent> SmoothAll(const Fitting& fitting, std::vector<Descent> fits,
                               SmoothBody::Numbers numbers = SmoothBody::Numbers::kFew) {
  for (Descent& fit : fits) {
    if (KindOf(fitting, fit.hypothesis.body) != Kind::kTrusted) fit = fitting.Smooth(fit, numbers);
  }
  return fits;
}

// The descents of all bodies whose kind passes, as they begin; those that diverge are left out.
std::vector<Descent> BeginAll(const Fitting& fitting, const std::vector<EffectValues>& known,
                              bool (*passes)(Kind)) {
  std::vector<Descent> fits;
  for (std::size_t body = 0; body < fitting.bodies().size(); ++body) {
    if (!passes(KindOf(fitting, body))) continue;
    Descent fit = fitting.Begin(body, known);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  }
  return fits;
}

// The laws that fit best. They change bodies so much that common factors begin anew; so does the
// body alone that they are compared with, whose steps the journal has already. Strong laws meet all
// bodies.
std::vector<Descent> FitLaws(const Fitting& fitting, const Descent& body,
                             const std::vector<const Effect*>& effects, const WorkShare& stage) {
  std::vector<Descent> fits;
  const Hypothesis& hypothesis = body.hypothesis;
  const auto add = [&](std::size_t n, const EffectValues& law) {
    std::vector<EffectValues> values = hypothesis.effects;
    values.push_back(law);
    Descent fit = fitting.Begin(n, values);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  };
  std::vector<Descent> alone = {fitting.Begin(hypothesis.body, hypothesis.effects)};
  Halve(fitting, kLawCuts, stage.Part(0, 0.03), kWithoutEffect, &alone);
  const SpringMassSystem system = fitting.Model(hypothesis).Apply(body.x);
  for (const Effect* effect : effects) {
    for (const Eigen::VectorXd& start : effect->Starts(system)) {
      if (effect->MakeTension(start)) add(hypothesis.body, {effect->name(), start});
    }
  }
  Halve(fitting, kLawCuts, stage.Part(0.03, 0.5), kWithLaw, &fits);
  std::vector<EffectValues> strong;
  for (const Descent& fit : fits) {
    if (alone.empty() || IsStrongLaw(fit.misfit, alone.front().misfit)) {
      strong.push_back(fit.hypothesis.effects.back());
    }
  }
  if (!strong.empty()) {
    strong.resize(std::min(strong.size(), kMostStrong));
    fits.clear();
    for (const EffectValues& law : strong) {
      for (std::size_t n = 0; n < fitting.bodies().size(); ++n) {
        if (KindOf(fitting, n) != Kind::kTrained) add(n, law);
      }
    }
    Halve(fitting, kStrongCuts, stage.Part(0.5, 1), kWithLaw, &fits);
  }
  Keep(strong.empty() ? kBestLaws : kBestStrong, &fits);
  return fits;
}

// The traces with the best scores, as far as they are worth a refit.
std::vector<EffectTrace> BestTraces(std::vector<EffectTrace> traces) {
  std::erase_if(traces, [](const EffectTrace& trace) { return trace.start.size() == 0; });
  std::stable_sort(traces.begin(), traces.end(),
                   [](const EffectTrace& p, const EffectTrace& q) { return p.score > q.score; });
  traces.resize(std::min(traces.size(), kTracedEffects));
  const double best = traces.empty() ? 0 : traces.front().score;
  std::erase_if(traces, [&](const EffectTrace& trace) { return !IsWorthRefit(trace.score, best); });
  return traces;
}

// Adds the fit with each of the best effects of a trace.
void AddTraced(const Descent& fit, const std::vector<EffectTrace>& traces,
               std::vector<Descent>* fits) {
  for (const EffectTrace& trace : BestTraces(traces)) {
    fits->push_back(fit.WithNewEffect({trace.effect->name(), trace.start}));
  }
}

// Fits with effects on bodies that were fitted under the highest gain only. They become smooth once
// the effect is there.
std::vector<Descent> FitFromStart(const Fitting& fitting, const std::vector<Descent>& bodies,
                                  const std::vector<const Effect*>& effects,
                                  const WorkShare& stage) {
  if (bodies.empty()) return {};
  std::vector<Descent> fits = FitLaws(fitting, bodies.front(), effects, stage.Part(0, 0.4));
  const std::vector<EffectTrace> traces =
      TraceEffects(fitting, bodies.front(), effects, kEarlyTraceGain, stage.Part(0.4, 0.6));
  for (const Descent& body : bodies) AddTraced(body, traces, &fits);
  Halve(fitting, kEarlyCuts, stage.Part(0.6, 1), " from the start on", &fits);
  return SmoothAll(fitting, fits);
}

}  // namespace

std::optional<Descent> FitTrained(const Fitting& fitting, const std::vector<EffectValues>& known,
                                  const WorkShare& stage) {
  std::vector<Descent> fits = SmoothAll(
      fitting, BeginAll(fitting, known, [](Kind kind) { return kind == Kind::kTrained; }));
  Halve(fitting, kTrainedCuts, stage, kWithoutEffect, &fits);
  if (fits.empty()) return {};
  return fits.front();
}

std::optional<FittedBodies> FitBodies(const Fitting& fitting,
                                      const std::vector<EffectValues>& known,
                                      const std::optional<Descent>& trained,
                                      const WorkShare& stage) {
  std::vector<Descent> early =
      BeginAll(fitting, known, [](Kind kind) { return kind != Kind::kTrained; });
  Halve(fitting, kEarlyBodyCuts, stage.Part(0, 0.3), kWithoutEffect, &early);
  std::vector<Descent> fits = SmoothAll(fitting, early);
  Halve(fitting, kBodyCuts, stage.Part(0.3, 1), kWithoutEffect, &fits);
  if (trained) fits.push_back(*trained);
  Keep(kBodyCuts.back(), &fits);
  if (fits.empty()) return {};
  return FittedBodies{early, fits.front()};
}

std::optional<Verdict> FitFreely(const Fitting& fitting, const WorkShare& stage,
                                 const Descent& body) {
  std::vector<Descent> fits = {body};
  Halve(fitting, kFreeCuts, stage, kWithoutEffect, &fits);
  if (fits.empty()) return {};
  return fitting.Judge(fits.front());
}

EffectSearchResult SearchEffects(const Fitting& fitting, const FittedBodies& bodies,
                                 const std::vector<const Effect*>& effects,
                                 const WorkShare& stage) {
  EffectSearchResult result;
  std::vector<Descent> fits = FitFromStart(fitting, bodies.early, effects, stage.Part(0, 0.2));
  const Descent& fitted = bodies.fitted;
  result.traces = TraceEffects(fitting, fitted, effects, kTraceGain, stage.Part(0.2, 0.3));
  AddTraced(fitted, result.traces, &fits);
  Halve(fitting, kCuts, stage.Part(0.3, 1), "", &fits);
  result.verdicts = JudgeAndSort(fitting, fits);
  // keeps the body that predicts best for each effect
  std::map<std::string, int> seen;
  std::erase_if(result.verdicts, [&](const Verdict& verdict) {
    return seen[verdict.descent.hypothesis.NewEffect()]++ > 0;
  });
  return result;
}

std::optional<Verdict> Refine(const Fitting& fitting, const WorkShare& stage,
                              const Descent& descent, double least_misfit) {
  std::vector<Descent> again = SmoothAll(fitting, {descent}, SmoothBody::Numbers::kAll);
  double done = 0;
  for (const Cut& cut : kAgainCuts) {
    const double part = done + 1.0 / kAgainCuts.size();
    Halve(fitting, {&cut, 1}, stage.Part(done, part), " once more", &again);
    done = part;
    if (again.empty() || IsHopeless(again[0].misfit, least_misfit)) return {};
  }
  return fitting.Judge(again[0]);
}

}  // namespace physpring
