// SPDX-License-Identifier: Apache-2.0
// The three nouns of a diagnosis.
//   Hypothesis   what may be the case: one of the bodies, with these effects
//   Descent      where its fit is: common factors and the effects' values
//   Verdict      a spring-mass system that was judged: its errors, and where it comes from
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_HYPOTHESIS_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_HYPOTHESIS_H_

#include <limits>
#include <string>
#include <vector>

#include "trainer/diagnosis/effect_problem.h"

namespace physpring {

struct Hypothesis {
  std::size_t body = 0;               // of Fitting::bodies
  std::vector<EffectValues> effects;  // as the search begins; the new one last
  double start_substeps = 0;          // a frame, as stiff as which the body's springs begin

  // Of all effects.
  Eigen::Index ParameterCount() const {
    Eigen::Index count = 0;
    for (const EffectValues& effect : effects) count += effect.values.size();
    return count;
  }
  // Of the new effect, and its name; 0 and empty without any.
  Eigen::Index NewParameters() const { return effects.empty() ? 0 : effects.back().values.size(); }
  std::string NewEffect() const { return effects.empty() ? "" : effects.back().name; }
};

struct Descent {
  Hypothesis hypothesis;
  Eigen::VectorXd x;  // common factors, then effects (effect_model.h); empty: no motion is stable
  double misfit = std::numeric_limits<double>::infinity();  // mean of r^2, m^2, where last fitted
  double damping = 1e-2;
  bool converged = false;
};

// Mean track errors, m; NaN where there are no such frames.
struct TrackPair {
  double fit, held;
};

struct Verdict {
  enum class Provenance { kCommonFactors, kSprings, kTraining };
  Provenance provenance = Provenance::kCommonFactors;
  Descent descent;  // that it comes from; of a training there is none
  SpringMassSystem system;
  bool controller_velocity = true;  // whether dashpots feel it
  FrameTrack held;
  TrackPair track{};
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_HYPOTHESIS_H_
