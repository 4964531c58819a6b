// SPDX-License-Identifier: Apache-2.0
// What a diagnosis moves: an unconstrained vector, and the map from it to a spring-mass system with
// effects. First the model's own parameters (parameters.h), then the values of the effects, one
// after the other:
//   own:      common factors, limit tanh(scale x / limit), or scale x without a limit; or the
//             numbers of a smooth body (trainer/bodies/smooth_body.h)
//   effects:  effect_entries.h
// Zero is the base system with the effects at their start. Effects of the base itself stay as they
// are, before these.
#ifndef PHYSPRING_DIAGNOSIS_EFFECT_MODEL_H_
#define PHYSPRING_DIAGNOSIS_EFFECT_MODEL_H_

#include <limits>
#include <memory>
#include <vector>

#include "trainer/bodies/effect_entries.h"
#include "trainer/bodies/parameters.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/solvers/levenberg_marquardt.h"

namespace physpring {

// The precision of the prior on common factors and on effects.
inline constexpr double kDiagnosisPrecision = kLevenbergMarquardtPrecision;

class EffectModel {
 public:
  struct OwnRange {
    double scale = 1;
    // Bounds what is handed to `own`, either way.
    double limit = std::numeric_limits<double>::infinity();
  };

  EffectModel(Parameters own, OwnRange range, std::vector<EffectValues> start);
  EffectModel(std::shared_ptr<const SmoothBody> body, std::vector<EffectValues> start);

  int size() const { return own_.size() + effects_.size(); }
  int effect_size() const { return effects_.size(); }
  const Parameters& own() const { return own_; }

  SpringMassSystem Apply(const Eigen::VectorXd& x) const;

  // The prior's precision near x.
  Eigen::MatrixXd Precision(const Eigen::VectorXd& x) const;

 private:
  Eigen::VectorXd OwnValues(const Eigen::VectorXd& x) const;

  Parameters own_;
  OwnRange range_;
  std::shared_ptr<const SmoothBody> smooth_;  // null: common factors
  EffectEntries effects_;
};

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_EFFECT_MODEL_H_
