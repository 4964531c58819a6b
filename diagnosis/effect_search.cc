// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "diagnosis/acceptance.h"

namespace physpring {
namespace {

constexpr std::size_t kTracedEffects = 6;  // no more than these are tried on fitted bodies
// Effects are tried on no more than these bodies from the start on.
constexpr std::size_t kEarlyBodies = 2;
constexpr double kEarlyTraceGain = 0.2, kTraceGain = 0.1;
// Parts of a search's work that are done after effects are tried from the start on, and after they
// are traced.
constexpr double kEarlyShare = 0.4, kTraceShare = 0.5;
constexpr std::size_t kMostStrong = 4;
constexpr char kWithoutEffect[] = " without any new effect", kWithLaw[] = " with another law";

// How many steps all fits make, and how many fits go on after that: in all, and with one effect.
struct Cut {
  double gain;
  int steps;
  std::size_t kept, of_an_effect;
};
// In this order: bodies without effects under the highest gain, down to the one of the trace, and
// down to none; laws on the best body, strong ones on all; all effects before the trace, and after
// it; one fit once more.
constexpr std::array<Cut, 1> kEarlyBodyCuts = {{{0.5, 5, 4, 4}}};
constexpr std::array<Cut, 2> kBodyCuts = {{{0.2, 5, 3, 3}, {0.1, 10, 2, 2}}};
constexpr std::array<Cut, 2> kFreeCuts = {{{0.05, 4, 2, 2}, {0, 8, 2, 2}}};
constexpr std::array<Cut, 1> kLawCuts = {{{0.5, 2, 12, 4}}};
constexpr std::array<Cut, 2> kStrongCuts = {{{0.5, 2, 8, 6}, {0.5, 6, 4, 3}}};
constexpr std::array<Cut, 1> kEarlyCuts = {{{0.2, 4, 8, 2}}};
constexpr std::array<Cut, 3> kCuts = {{{0.1, 2, 10, 2}, {0.05, 3, 6, 2}, {0, 12, 6, 2}}};
constexpr std::array<Cut, 4> kAgainCuts = {
    {{0.2, 4, 1, 1}, {0.1, 4, 1, 1}, {0.05, 4, 1, 1}, {0, 12, 1, 1}}};

bool HasFreeForm(const Descent& descent) { return IsFreeForm(descent.hypothesis.NewParameters()); }

// Keeps the best fits by misfit and, beside others, the best one of each free form.
void Keep(std::size_t count, std::size_t of_an_effect, std::vector<Descent>* fits) {
  std::stable_sort(fits->begin(), fits->end(),
                   [](const Descent& p, const Descent& q) { return p.misfit < q.misfit; });
  const auto best = std::find_if_not(fits->begin(), fits->end(), HasFreeForm);
  const bool competing = best != fits->end();  // else all have the same effect, maybe a known one
  const double least = competing ? best->misfit : fits->empty() ? 0 : fits->front().misfit;
  std::map<std::string, std::size_t> kept;
  std::size_t others = 0;
  std::erase_if(*fits, [&](const Descent& fit) {
    const bool apart = competing && HasFreeForm(fit);
    if (kept[fit.hypothesis.NewEffect()]++ >= (apart ? 1 : of_an_effect)) return true;
    return !apart && (others++ >= count || IsHopeless(fit.misfit, least));
  });
}

// Successive halving; the best fit by misfit is the first one after it.
void Halve(const Fitting& fitting, std::span<const Cut> cuts, const WorkShare& stage,
           const std::string& of, std::vector<Descent>* fits) {
  if (fits->empty()) return;
  double done = 0, all = 0;  // steps, if each cut keeps as many as it may
  std::size_t count = fits->size();
  for (const Cut& cut : cuts) {
    all += static_cast<double>(count) * cut.steps;
    count = std::min(count, cut.kept);
  }
  for (const Cut& cut : cuts) {
    const int steps = static_cast<int>(fits->size()) * cut.steps;
    fitting.journal().Stage(
        stage.Part(done / all, std::min(1.0, (done + steps) / all)), steps,
        fmt::format("refitting {} models{}, gain {}", fits->size(), of, cut.gain));
    done += steps;
    for (Descent& fit : *fits) {
      fit.damping = 1e-2;
      fit.converged = false;
    }
    fitting.Descend(cut.gain, cut.steps, fits);
    Keep(cut.kept, cut.of_an_effect, fits);
  }
}

std::vector<Verdict> JudgeAndSort(const Fitting& fitting, const std::vector<Descent>& fits) {
  std::vector<Verdict> verdicts = fitting.JudgeAll(fits);
  std::stable_sort(verdicts.begin(), verdicts.end(),
                   [](const Verdict& p, const Verdict& q) { return p.track.held < q.track.held; });
  return verdicts;
}

// The fit with one more effect, from where the fit is.
Descent With(const Descent& fit, const EffectTrace& trace) {
  Descent with = fit;
  with.hypothesis.effects.push_back({trace.effect->name(), trace.start});
  with.x.conservativeResizeLike(Eigen::VectorXd::Zero(fit.x.size() + trace.start.size()));
  return with;
}

// Laws of the springs change bodies so much that these begin anew; so does the body alone that
// they are compared with, whose steps the journal has already.
std::vector<Descent> FitLaws(const Fitting& fitting, const std::vector<Descent>& bodies,
                             const std::vector<const Effect*>& effects, const WorkShare& stage) {
  std::vector<Descent> fits;
  const Descent& first = bodies.front();
  const auto add = [&](std::size_t body, const EffectValues& law) {
    std::vector<EffectValues> values = first.hypothesis.effects;
    values.push_back(law);
    Descent fit = fitting.Begin(body, values);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  };
  std::vector<Descent> alone = {fitting.Begin(first.hypothesis.body, first.hypothesis.effects)};
  Halve(fitting, kLawCuts, stage.Part(0, 0.03), kWithoutEffect, &alone);
  for (const Effect* effect : effects) {
    for (const Eigen::VectorXd& start :
         effect->Starts(fitting.Model(first.hypothesis).Apply(first.x))) {
      if (effect->MakeTension(start)) add(first.hypothesis.body, {effect->name(), start});
    }
  }
  Halve(fitting, kLawCuts, stage.Part(0.03, 0.5), kWithLaw, &fits);
  std::vector<EffectValues> strong;
  for (const Descent& fit : fits) {
    if (IsStrongLaw(fit.misfit, alone.front().misfit))
      strong.push_back(fit.hypothesis.effects.back());
  }
  if (strong.empty()) {
    Keep(fits.size(), 1, &fits);
    return fits;
  }
  strong.resize(std::min(strong.size(), kMostStrong));
  fits.clear();
  for (const EffectValues& law : strong) {
    for (std::size_t body = 0; body < fitting.bodies().size(); ++body) add(body, law);
  }
  Halve(fitting, kStrongCuts, stage.Part(0.5, 1), kWithLaw, &fits);
  return fits;
}

// Fits with effects on bodies that were fitted under the highest gain only.
std::vector<Descent> FitFromStart(const Fitting& fitting, const std::vector<Descent>& bodies,
                                  const std::vector<const Effect*>& effects,
                                  const WorkShare& stage) {
  if (bodies.empty()) return {};
  std::vector<Descent> fits = FitLaws(fitting, bodies, effects, stage.Part(0, 0.3));
  for (const EffectTrace& trace :
       TraceEffects(fitting, bodies.front(), effects, kEarlyTraceGain, stage.Part(0.3, 0.5))) {
    if (trace.start.size() == 0) continue;
    for (std::size_t i = 0; i < std::min(bodies.size(), kEarlyBodies); ++i) {
      fits.push_back(With(bodies[i], trace));
    }
  }
  Halve(fitting, kEarlyCuts, stage.Part(0.5, 1), " from the start on", &fits);
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

}  // namespace

FittedBodies FitBodies(const Fitting& fitting, const std::vector<EffectValues>& known,
                       const WorkShare& stage) {
  FittedBodies bodies;
  std::vector<Descent>& fits = bodies.fitted;
  for (std::size_t body = 0; body < fitting.bodies().size(); ++body) {
    Descent fit = fitting.Begin(body, known);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  }
  Halve(fitting, kEarlyBodyCuts, stage.Part(0, 0.3), kWithoutEffect, &fits);
  bodies.early = fits;
  Halve(fitting, kBodyCuts, stage.Part(0.3, 1), kWithoutEffect, &fits);
  return bodies;
}

std::vector<Verdict> FitFreely(const Fitting& fitting, const WorkShare& stage,
                               std::vector<Descent> bodies) {
  Halve(fitting, kFreeCuts, stage, kWithoutEffect, &bodies);
  return JudgeAndSort(fitting, bodies);
}

EffectSearchResult SearchEffects(const Fitting& fitting, const FittedBodies& bodies,
                                 const std::vector<const Effect*>& effects,
                                 const WorkShare& stage) {
  EffectSearchResult result;
  std::vector<Descent> fits =
      FitFromStart(fitting, bodies.early, effects, stage.Part(0, kEarlyShare));
  result.traces = TraceEffects(fitting, bodies.fitted.front(), effects, kTraceGain,
                               stage.Part(kEarlyShare, kTraceShare));
  for (const EffectTrace& trace : BestTraces(result.traces)) {
    for (const Descent& body : bodies.fitted) fits.push_back(With(body, trace));
  }
  Halve(fitting, kCuts, stage.Part(kTraceShare, 1), "", &fits);
  result.verdicts = JudgeAndSort(fitting, fits);
  // keeps the body that predicts best for each effect
  std::map<std::string, int> seen;
  std::erase_if(result.verdicts, [&](const Verdict& verdict) {
    return seen[verdict.descent.hypothesis.NewEffect()]++ > 0;
  });
  return result;
}

Verdict FollowAgain(const Fitting& fitting, const WorkShare& stage, const Verdict& verdict) {
  std::vector<Descent> again = {verdict.descent};
  Halve(fitting, kAgainCuts, stage, " once more", &again);
  if (again.empty() || again[0].misfit >= verdict.descent.misfit) return verdict;
  const std::optional<Verdict> better = fitting.Judge(again[0]);
  return better ? *better : verdict;
}

}  // namespace physpring
