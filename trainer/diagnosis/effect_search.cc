// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "trainer/diagnosis/block_bootstrap.h"

namespace physpring {
namespace {

using Horizon = EffectFitting::Horizon;

constexpr std::size_t kTracedBodies = 2;
constexpr std::size_t kTracedEffects = 6;  // that are refitted
constexpr int kBodySteps = 10;
// Physics that is missing is missing from all bodies alike: one whose mean square misfit is so many
// times that of the best is not tried with effects.
constexpr double kHopeless = 2;
constexpr int kDraws = 1000;

// Steps of all fits, and how many of them go on after that: in all, and with one effect.
struct Cut {
  Horizon horizon;
  int steps;
  std::size_t kept, of_an_effect;
};
constexpr std::array<Cut, 4> kCuts = {{{Horizon::kShort, 3, 12, 3},
                                       {Horizon::kShort, 6, 8, 2},
                                       {Horizon::kAll, 4, 6, 2},
                                       {Horizon::kAll, 8, 6, 2}}};
constexpr std::array<Cut, 1> kBodyCuts = {{{Horizon::kAll, 10, 2, 2}}};

std::string NewEffect(const EffectFit& fit) {
  return fit.start.empty() ? "" : fit.start.back().name;
}

Eigen::Index ParameterCount(const EffectFit& fit) {
  Eigen::Index count = 0;
  for (const EffectValues& effect : fit.start) count += effect.values.size();
  return count;
}

// The best by misfit.
void Keep(std::size_t count, std::size_t of_an_effect, std::vector<EffectFit>* fits) {
  std::stable_sort(fits->begin(), fits->end(),
                   [](const EffectFit& p, const EffectFit& q) { return p.misfit < q.misfit; });
  std::map<std::string, std::size_t> kept;
  std::erase_if(*fits,
                [&](const EffectFit& fit) { return kept[NewEffect(fit)]++ >= of_an_effect; });
  fits->resize(std::min(fits->size(), count));
}

template <class Cuts>
void Halve(const EffectFitting& fitting, const Cuts& cuts, const SearchProgress& progress,
           std::vector<EffectFit>* fits) {
  double share = 0.3;
  for (const Cut& cut : cuts) {
    if (progress) {
      progress(share, fmt::format("refitting {} models over {} fit frames", fits->size(),
                                  cut.horizon == Horizon::kShort ? "the first" : "all"));
    }
    share += 0.15;
    for (EffectFit& fit : *fits) {
      fit.damping = 1e-2;
      fit.converged = false;
    }
    fitting.Descend(cut.horizon, cut.steps, fits);
    Keep(cut.kept, cut.of_an_effect, fits);
  }
  fitting.JudgeAll(fits);
  std::stable_sort(fits->begin(), fits->end(), [](const EffectFit& p, const EffectFit& q) {
    return p.track.held < q.track.held;
  });
}

}  // namespace

std::vector<EffectFit> FitBodies(EffectFitting* fitting, const std::vector<EffectValues>& known) {
  std::vector<EffectFit> fits;
  for (std::size_t body = 0; body < fitting->bodies().size(); ++body) {
    EffectFit fit = fitting->Begin(body, known);
    if (fit.x.size() > 0) fits.push_back(std::move(fit));
  }
  fitting->Descend(Horizon::kShort, kBodySteps, &fits);
  return fits;
}

std::optional<EffectFit> FitBest(const EffectFitting& fitting, std::vector<EffectFit> bodies) {
  Keep(kBodyCuts[0].kept, kBodyCuts[0].kept, &bodies);
  Halve(fitting, kBodyCuts, {}, &bodies);
  if (bodies.empty()) return {};
  return bodies[0];
}

EffectSearchResult SearchEffects(const EffectFitting& fitting, const std::vector<EffectFit>& bodies,
                                 const std::vector<const Effect*>& effects,
                                 const SearchProgress& progress) {
  EffectSearchResult result;
  std::vector<EffectFit> traced = bodies;
  Keep(kTracedBodies, kTracedBodies, &traced);
  for (std::size_t i = 0; i < traced.size(); ++i) {
    if (progress) progress(0.15 * static_cast<double>(i), "tracing the effects");
    const std::vector<EffectTrace> traces = TraceEffects(fitting, traced[i], effects);
    if (i == 0) result.traces = traces;
    for (std::size_t n = 0; n < traces.size(); ++n) {
      if (traces[n].score > result.traces[n].score) result.traces[n] = traces[n];
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < effects.size(); ++n) {
    if (result.traces[n].start.size() > 0) order.push_back(n);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return result.traces[i].score > result.traces[j].score;
  });
  order.resize(std::min(order.size(), kTracedEffects));
  for (std::size_t n : order) {
    const EffectTrace& trace = result.traces[n];
    for (const EffectFit& body : bodies) {
      if (body.misfit > kHopeless * traced[0].misfit) continue;
      EffectFit fit = body;
      fit.start.push_back({trace.effect->name(), trace.start});
      fit.x.conservativeResizeLike(Eigen::VectorXd::Zero(body.x.size() + trace.start.size()));
      result.fits.push_back(std::move(fit));
    }
  }
  Halve(fitting, kCuts, progress, &result.fits);
  // of each effect the body that predicts best
  std::map<std::string, int> seen;
  std::erase_if(result.fits, [&](const EffectFit& fit) { return seen[NewEffect(fit)]++ > 0; });
  return result;
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
        BlockBootstrap(Difference(fits[i].held, fits[best].held), block, kDraws, seed);
    if (worse.mean <= worse.error) chosen = i;
  }
  return chosen;
}

}  // namespace physpring
