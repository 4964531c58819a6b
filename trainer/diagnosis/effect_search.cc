// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "trainer/diagnosis/block_bootstrap.h"

namespace physpring {
namespace {

constexpr std::size_t kTracedEffects = 6;  // on fitted bodies that are refitted at most ...
constexpr double kLeastScore = 0.05;       // ... if the trace gives them such a part of the best
constexpr std::size_t kEarlyBodies = 2;    // that effects are tried on from the start on
constexpr double kEarlyTraceGain = 0.2, kTraceGain = 0.1;
constexpr int kSimplestDraws = 1000;
constexpr double kEarlyShare = 0.4, kTraceShare = 0.5;  // of the work of a search, until then
// of the misfit that the body alone has after as many steps, what a strong law leaves
constexpr double kStrong = 0.7;
constexpr std::size_t kMostStrong = 4;
constexpr char kWithoutEffect[] = " without any new effect", kWithLaw[] = " with another law";

// Steps of all fits, and how many of them go on after that: in all, and with one effect.
struct Cut {
  double gain;
  int steps;
  std::size_t kept, of_an_effect;
};
// Bodies without effects: under the highest gain, down to the one of the trace, down to none; laws
// on the best body, strong ones on all; all effects before the trace, and after it.
constexpr std::array<Cut, 1> kEarlyBodyCuts = {{{0.5, 5, 4, 4}}};
constexpr std::array<Cut, 2> kBodyCuts = {{{0.2, 5, 3, 3}, {0.1, 10, 2, 2}}};
constexpr std::array<Cut, 2> kFreeCuts = {{{0.05, 4, 2, 2}, {0, 8, 2, 2}}};
constexpr std::array<Cut, 1> kLawCuts = {{{0.5, 2, 12, 4}}};
constexpr std::array<Cut, 2> kStrongCuts = {{{0.5, 2, 8, 6}, {0.5, 6, 4, 3}}};
constexpr std::array<Cut, 1> kEarlyCuts = {{{0.2, 4, 8, 2}}};
constexpr std::array<Cut, 3> kCuts = {{{0.1, 2, 10, 2}, {0.05, 3, 6, 2}, {0, 12, 6, 2}}};
constexpr std::array<Cut, 4> kAgainCuts = {
    {{0.2, 4, 1, 1}, {0.1, 4, 1, 1}, {0.05, 4, 1, 1}, {0, 12, 1, 1}}};

// Under an observer, a misfit so many times the least one is hopeless.
constexpr double kHopeless = 4;
constexpr Eigen::Index kFreeForm = 20;  // parameters

std::string NewEffect(const EffectFit& fit) {
  return fit.start.empty() ? "" : fit.start.back().name;
}

Eigen::Index ParameterCount(const EffectFit& fit) {
  Eigen::Index count = 0;
  for (const EffectValues& effect : fit.start) count += effect.values.size();
  return count;
}

// The best by misfit, and, beside others, the best free-form one.
void Keep(std::size_t count, std::size_t of_an_effect, std::vector<EffectFit>* fits) {
  std::stable_sort(fits->begin(), fits->end(),
                   [](const EffectFit& p, const EffectFit& q) { return p.misfit < q.misfit; });
  const auto best = std::find_if_not(fits->begin(), fits->end(), IsFreeForm);
  const bool competing = best != fits->end();  // else all have the same effect, maybe a known one
  const double least = competing ? best->misfit : fits->empty() ? 0 : fits->front().misfit;
  std::map<std::string, std::size_t> kept;
  std::size_t others = 0;
  std::erase_if(*fits, [&](const EffectFit& fit) {
    const bool apart = competing && IsFreeForm(fit);
    if (kept[NewEffect(fit)]++ >= (apart ? 1 : of_an_effect)) return true;
    return !apart && (others++ >= count || fit.misfit > kHopeless * least);
  });
}

// Successive halving; the best fit by misfit is the first one after it.
void Halve(const EffectFitting& fitting, std::span<const Cut> cuts, const WorkShare& stage,
           const std::string& of, std::vector<EffectFit>* fits) {
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
    for (EffectFit& fit : *fits) {
      fit.damping = 1e-2;
      fit.converged = false;
    }
    fitting.Descend(cut.gain, cut.steps, fits);
    Keep(cut.kept, cut.of_an_effect, fits);
  }
}

void JudgeAndSort(const EffectFitting& fitting, std::vector<EffectFit>* fits) {
  fitting.JudgeAll(fits);
  std::stable_sort(fits->begin(), fits->end(), [](const EffectFit& p, const EffectFit& q) {
    return p.track.held < q.track.held;
  });
}

// The fit with one more effect, from where the fit is.
EffectFit With(const EffectFit& fit, const EffectTrace& trace) {
  EffectFit with = fit;
  with.start.push_back({trace.effect->name(), trace.start});
  with.x.conservativeResizeLike(Eigen::VectorXd::Zero(fit.x.size() + trace.start.size()));
  return with;
}

// Laws of the springs change bodies so much that these begin anew; so does the body alone that
// they are compared with, whose steps the journal has already.
std::vector<EffectFit> FitLaws(const EffectFitting& fitting, const std::vector<EffectFit>& bodies,
                               const std::vector<const Effect*>& effects, const WorkShare& stage) {
  std::vector<EffectFit> fits;
  const EffectFit& first = bodies.front();
  const auto add = [&](std::size_t body, const EffectValues& law) {
    std::vector<EffectValues> values = first.start;
    values.push_back(law);
    EffectFit fit = fitting.Begin(body, values);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  };
  std::vector<EffectFit> alone = {fitting.Begin(first.body, first.start)};
  Halve(fitting, kLawCuts, stage.Part(0, 0.03), kWithoutEffect, &alone);
  for (const Effect* effect : effects) {
    for (const Eigen::VectorXd& start : effect->Starts(fitting.Model(first).Apply(first.x))) {
      if (effect->MakeTension(start)) add(first.body, {effect->name(), start});
    }
  }
  Halve(fitting, kLawCuts, stage.Part(0.03, 0.5), kWithLaw, &fits);
  std::vector<EffectValues> strong;
  for (const EffectFit& fit : fits) {
    if (fit.misfit < kStrong * alone.front().misfit) strong.push_back(fit.start.back());
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
std::vector<EffectFit> FitFromStart(const EffectFitting& fitting,
                                    const std::vector<EffectFit>& bodies,
                                    const std::vector<const Effect*>& effects,
                                    const WorkShare& stage) {
  if (bodies.empty()) return {};
  std::vector<EffectFit> fits = FitLaws(fitting, bodies, effects, stage.Part(0, 0.3));
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

}  // namespace

bool IsFreeForm(const EffectFit& fit) {
  return !fit.start.empty() && fit.start.back().values.size() > kFreeForm;
}

bool HasFreeForm(const Effect& effect) { return effect.value_count() > kFreeForm; }

FittedBodies FitBodies(const EffectFitting& fitting, const std::vector<EffectValues>& known,
                       const WorkShare& stage) {
  FittedBodies bodies;
  std::vector<EffectFit>& fits = bodies.fitted;
  for (std::size_t body = 0; body < fitting.bodies().size(); ++body) {
    EffectFit fit = fitting.Begin(body, known);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  }
  Halve(fitting, kEarlyBodyCuts, stage.Part(0, 0.3), kWithoutEffect, &fits);
  bodies.early = fits;
  Halve(fitting, kBodyCuts, stage.Part(0.3, 1), kWithoutEffect, &fits);
  return bodies;
}

void FitFreely(const EffectFitting& fitting, const WorkShare& stage,
               std::vector<EffectFit>* bodies) {
  Halve(fitting, kFreeCuts, stage, kWithoutEffect, bodies);
  JudgeAndSort(fitting, bodies);
}

EffectSearchResult SearchEffects(const EffectFitting& fitting, const FittedBodies& bodies,
                                 const std::vector<const Effect*>& effects,
                                 const WorkShare& stage) {
  EffectSearchResult result;
  result.fits = FitFromStart(fitting, bodies.early, effects, stage.Part(0, kEarlyShare));
  result.traces = TraceEffects(fitting, bodies.fitted.front(), effects, kTraceGain,
                               stage.Part(kEarlyShare, kTraceShare));
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < effects.size(); ++n) {
    if (result.traces[n].start.size() > 0) order.push_back(n);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return result.traces[i].score > result.traces[j].score;
  });
  order.resize(std::min(order.size(), kTracedEffects));
  const double least = order.empty() ? 0 : kLeastScore * result.traces[order.front()].score;
  std::erase_if(order, [&](std::size_t n) { return result.traces[n].score <= least; });
  for (std::size_t n : order) {
    for (const EffectFit& body : bodies.fitted) result.fits.push_back(With(body, result.traces[n]));
  }
  Halve(fitting, kCuts, stage.Part(kTraceShare, 1), "", &result.fits);
  JudgeAndSort(fitting, &result.fits);
  // of each effect the body that predicts best
  std::map<std::string, int> seen;
  std::erase_if(result.fits, [&](const EffectFit& fit) { return seen[NewEffect(fit)]++ > 0; });
  return result;
}

void FollowAgain(const EffectFitting& fitting, const WorkShare& stage, EffectFit* fit) {
  std::vector<EffectFit> again = {*fit};
  Halve(fitting, kAgainCuts, stage, " once more", &again);
  if (again.empty() || again[0].misfit >= fit->misfit || !fitting.Judge(&again[0])) return;
  *fit = std::move(again[0]);
}

std::size_t ChooseSimplest(const std::vector<EffectFit>& fits, int block, std::uint64_t seed) {
  const auto best =
      static_cast<std::size_t>(std::min_element(fits.begin(), fits.end(),
                                                [](const EffectFit& p, const EffectFit& q) {
                                                  return p.track.held < q.track.held;
                                                }) -
                               fits.begin());
  std::size_t chosen = best;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (ParameterCount(fits[i]) >= ParameterCount(fits[chosen])) continue;
    const BootstrapResult worse =
        BlockBootstrap(Difference(fits[i].held, fits[best].held), block, kSimplestDraws, seed);
    if (worse.mean <= worse.error) chosen = i;
  }
  return chosen;
}

}  // namespace physpring
