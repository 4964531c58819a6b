// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_VALUES_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_VALUES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace physpring {

// An effect that a system has: which, and the values of its parameters, one after the other
// (twin/effects/effect.h).
struct EffectValues {
  std::string name;
  Eigen::VectorXd values;

  bool operator==(const EffectValues& other) const {
    return name == other.name && values.size() == other.values.size() && values == other.values;
  }
};

// How many values they have together.
inline Eigen::Index EffectValueCount(const std::vector<EffectValues>& effects) {
  Eigen::Index count = 0;
  for (const EffectValues& effect : effects) count += effect.values.size();
  return count;
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_VALUES_H_
