// SPDX-License-Identifier: Apache-2.0
// The values of effects as unconstrained numbers x that a fit moves, one after the other:
//   even:         value = start + scale x
//   logarithmic:  value = start exp(x)
// within the parameter's bounds. Zero is the start.
#ifndef PHYSPRING_TRAINER_BODIES_EFFECT_ENTRIES_H_
#define PHYSPRING_TRAINER_BODIES_EFFECT_ENTRIES_H_

#include <vector>

#include "twin/effects/effect.h"

namespace physpring {

class EffectEntries {
 public:
  // `moment_unit`: moments move by so many of their scales.
  explicit EffectEntries(std::vector<EffectValues> start, double moment_unit = 1);

  int size() const { return static_cast<int>(entries_.size()); }
  // Whether an entry is one of several of a kind, as those along a body are.
  bool is_of_several(int i) const { return entries_[static_cast<std::size_t>(i)].of_several; }
  std::vector<EffectValues> Apply(const Eigen::VectorXd& x) const;

  // d loss / d x, from the derivatives with respect to the values of each effect. 0 where a value
  // is at its bound.
  Eigen::VectorXd Adjoint(const Eigen::VectorXd& x,
                          const std::vector<Eigen::VectorXd>& gradient) const;

 private:
  struct Entry {
    double start, low, high, scale;
    bool logarithmic, of_several;

    double Unbounded(double x) const;
  };

  std::vector<EffectValues> start_;
  std::vector<Entry> entries_;  // of all effects
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_EFFECT_ENTRIES_H_
