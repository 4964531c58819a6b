// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/last_fit.h"

#include <limits>

namespace physpring {
namespace {

constexpr int kSteps = 24;
constexpr double kTolerance = 2e-4;  // part of the squared misfit that a step must take away

}  // namespace

std::optional<EffectFit> FitAllFrames(const EffectFitting& fitting, const WorkShare& share,
                                      const EffectFit& chosen) {
  std::vector<SplitRecording> all;
  for (const SplitRecording& split : fitting.recordings()) all.push_back(FitHeldOut(split));
  // effects of the body itself stay as they are, before those that were added
  const std::vector<EffectValues>& own = fitting.bodies()[chosen.body].base.effects;
  const std::vector<EffectValues> added(
      chosen.system.effects.begin() + static_cast<long>(own.size()), chosen.system.effects.end());
  DiagnosisBody body{chosen.system, chosen.controller_velocity, true, "as chosen"};
  body.base.effects = own;
  const EffectFitting fitting_all({body}, all, fitting.threads(), &fitting.journal());
  std::vector<EffectFit> fits = {fitting_all.Begin(0, added)};
  if (fits[0].x.size() == 0) return {};
  fitting.journal().Stage(share, kSteps, "fitting to all frames");
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    fits[0].converged = false;
    fitting_all.Descend(0, 1, &fits);
    if (fits.empty()) return {};
    if (fits[0].misfit > (1 - kTolerance) * before) break;
    before = fits[0].misfit;
  }
  if (!fitting_all.Judge(&fits[0])) return {};
  return fits[0];
}

}  // namespace physpring
