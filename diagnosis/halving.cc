// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/halving.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "diagnosis/acceptance.h"
#include "trainer/motion/observer.h"

namespace physpring {
namespace {

bool HasFreeForm(const Descent& descent) { return IsFreeForm(descent.hypothesis.NewParameters()); }

}  // namespace

void Keep(const Cut& cut, std::vector<Descent>* fits) {
  std::stable_sort(fits->begin(), fits->end(),
                   [](const Descent& p, const Descent& q) { return p.misfit < q.misfit; });
  const auto best = std::find_if_not(fits->begin(), fits->end(), HasFreeForm);
  const bool competing = best != fits->end();  // else all have the same effect, maybe a known one
  const double least = competing ? best->misfit : fits->empty() ? 0 : fits->front().misfit;
  std::map<std::string, std::size_t> kept;
  std::size_t others = 0;
  std::erase_if(*fits, [&](const Descent& fit) {
    const bool apart = competing && HasFreeForm(fit);
    if (cut.gain < kObserverGains[0] && IsHopeless(fit.misfit, least)) return true;
    if (kept[fit.hypothesis.NewEffect()]++ >= (apart ? 1 : cut.of_an_effect)) return true;
    return !apart && others++ >= cut.kept;
  });
}

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
    fitting.Descend(cut.gain, cut.care, cut.steps, fits);
    Keep(cut, fits);
  }
}

std::vector<Verdict> JudgeAndSort(const Fitting& fitting, const std::vector<Descent>& fits) {
  std::vector<Verdict> verdicts = fitting.JudgeAll(fits);
  std::stable_sort(verdicts.begin(), verdicts.end(),
                   [](const Verdict& p, const Verdict& q) { return p.track.held < q.track.held; });
  return verdicts;
}

}  // namespace physpring
