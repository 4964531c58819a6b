// SPDX-License-Identifier: Apache-2.0
// The effects that a simulated scene can get besides what its file tells, as a user names them:
// EFFECT.PARAMETER, with the names and units of a diagnosis' report where it has the effect, too.
// What they do is in undeclared_effects.h.
#ifndef PHYSPRING_ROLLOUT_EFFECT_KEYS_H_
#define PHYSPRING_ROLLOUT_EFFECT_KEYS_H_

#include <map>
#include <string>
#include <vector>

namespace physpring {

struct EffectKey {
  std::string name;  // "tether.stiffness_n_per_m"
  double low, high;  // bounds of the value
  bool amount;       // without it, or with 0, the effect is not there
  std::string what;  // what MuJoCo does, for people

  std::string effect() const { return name.substr(0, name.find('.')); }
};

const std::vector<EffectKey>& EffectKeys();

// Values by name.
using SceneEffects = std::map<std::string, double>;

// "NAME=VALUE" to its parts. Throws Error, one line, if there is no such name (it lists those that
// come near) or the value is no number within the bounds.
std::pair<std::string, double> ParseEffect(const std::string& text);

// Throws Error if a name is unknown, a value out of its bounds, or an effect is given without an
// amount.
void ExpectEffects(const SceneEffects& effects);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EFFECT_KEYS_H_
