// SPDX-License-Identifier: Apache-2.0
// The trace: how much of the squared misfit under an observer each effect could take away, beyond
// what the model's own parameters can, before anything is refitted.
//   start     of an effect's many starts, the two whose whole response, less what the model's own
//             parameters could do alike, lies along the residuals most (one rollout each)
//   step      from these, one damped step of Gauss-Newton with all parameters, the better of them
#ifndef PHYSPRING_DIAGNOSIS_EFFECT_TRACE_H_
#define PHYSPRING_DIAGNOSIS_EFFECT_TRACE_H_

#include <vector>

#include "diagnosis/fitting.h"
#include "twin/effects/effect.h"

namespace physpring {

struct EffectTrace {
  const Effect* effect = nullptr;
  double score = 0;       // part of the squared misfit that the step takes away
  Eigen::VectorXd start;  // empty if the effect cannot be evaluated here
};

// The trace of each of `effects` added to `fit`, in their order, under an observer of this gain.
// `stage` is the share of the work.
std::vector<EffectTrace> TraceEffects(const Fitting& fitting, const Descent& fit,
                                      const std::vector<const Effect*>& effects, double gain,
                                      const WorkShare& stage);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_EFFECT_TRACE_H_
