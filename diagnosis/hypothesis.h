// SPDX-License-Identifier: Apache-2.0
// The three nouns of a diagnosis.
//   Hypothesis   what may be the case: one of the bodies, with these effects
//   Descent      where its fit is: the body's numbers and the effects' values
//   Verdict      a spring-mass system that was judged: its errors, and where it comes from
#ifndef PHYSPRING_DIAGNOSIS_HYPOTHESIS_H_
#define PHYSPRING_DIAGNOSIS_HYPOTHESIS_H_

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/effect_problem.h"

namespace physpring {

// A smooth body, and the numbers of all bodies that it comes from.
struct SmoothStart {
  Eigen::VectorXd from;
  std::shared_ptr<const SmoothBody> body;
};

struct Hypothesis {
  std::size_t body = 0;               // an index of Fitting::bodies
  std::vector<EffectValues> effects;  // as the search begins with them; the new one is last
  double start_substeps = 0;  // the body's springs begin as stiff as so many sub-steps a frame
  std::optional<SmoothStart> material =
      {};  // where the body is a smooth one, not of common factors

  // How many parameters all effects have.
  Eigen::Index ParameterCount() const { return EffectValueCount(effects); }
  // How many the new effect has, and its name; 0 and empty without any.
  Eigen::Index NewParameters() const { return effects.empty() ? 0 : effects.back().values.size(); }
  std::string NewEffect() const { return effects.empty() ? "" : effects.back().name; }
};

struct Descent {
  Hypothesis hypothesis;
  Eigen::VectorXd
      x;  // the body's numbers, then effects (effect_model.h); empty: no motion is stable
  // The mean of r^2, m^2, when the descent was last fitted.
  double misfit = std::numeric_limits<double>::infinity();
  double damping = 1e-2;
  bool converged = false;

  // The same with one more effect, as it begins.
  Descent WithNewEffect(const EffectValues& effect) const {
    Descent with = *this;
    with.hypothesis.effects.push_back(effect);
    with.x.conservativeResizeLike(Eigen::VectorXd::Zero(x.size() + effect.values.size()));
    return with;
  }
  // The same without the new effect.
  Descent WithoutNewEffect() const {
    Descent without = *this;
    without.x.conservativeResize(x.size() - hypothesis.NewParameters());
    without.hypothesis.effects.pop_back();
    return without;
  }
};

// Mean track errors, m; NaN where there are no such frames.
struct TrackPair {
  double fit, held;
};

struct Verdict {
  enum class Provenance { kRefit, kTraining };
  Provenance provenance = Provenance::kRefit;
  Descent descent;  // what it comes from; a training has none
  SpringMassSystem system;
  bool controller_velocity = true;  // whether dashpots feel that
  FrameTrack held;
  TrackPair track{};
};

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_HYPOTHESIS_H_
