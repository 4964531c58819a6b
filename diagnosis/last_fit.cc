// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/last_fit.h"

#include <limits>

namespace physpring {
namespace {

constexpr int kSteps = 24;
constexpr double kTolerance = 2e-4;  // part of the squared misfit that a step must take away

}  // namespace

std::optional<Verdict> FitAllFrames(const Fitting& fitting, const WorkShare& share,
                                    const Verdict& chosen) {
  std::vector<SplitRecording> all;
  for (const SplitRecording& split : fitting.recordings()) all.push_back(FitHeldOut(split));
  const bool smooth = chosen.descent.hypothesis.material.has_value();
  // effects of the body itself (only a body without others has any) stay as they are, before those
  // that were added
  const std::vector<EffectValues>& own = fitting.bodies()[0].base.effects;
  const std::vector<EffectValues> added(
      chosen.system.effects.begin() + static_cast<long>(own.size()), chosen.system.effects.end());
  DiagnosisBody body{chosen.system, chosen.controller_velocity, DiagnosisBody::Kind::kTrusted,
                     "as chosen"};
  body.base.effects = own;
  const Fitting fitting_all(smooth ? fitting.bodies() : std::vector<DiagnosisBody>{body}, all,
                            fitting.threads(), &fitting.journal(), fitting.lasting_effects());
  std::vector<Descent> descents = {
      smooth ? fitting_all.Smooth(chosen.descent, SmoothBody::Numbers::kAll)
             : fitting_all.Begin(0, added)};
  if (descents[0].x.size() == 0) return {};
  fitting.journal().Stage(share, kSteps, "fitting to all frames");
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    descents[0].converged = false;
    fitting_all.Descend(0, Fitting::Care::kExact, 1, &descents);
    if (descents.empty()) return {};
    if (descents[0].misfit > (1 - kTolerance) * before) break;
    before = descents[0].misfit;
  }
  return fitting_all.Judge(descents[0]);
}

}  // namespace physpring
