// SPDX-License-Identifier: Apache-2.0
// The effects that a simulated scene can get besides what its file tells, as a user names them:
// EFFECT.PARAMETER, with the names and units of a diagnosis' report where it has the effect, too.
// What each does is said in its file in rollout/effects/.
#ifndef PHYSPRING_ROLLOUT_EFFECT_KEYS_H_
#define PHYSPRING_ROLLOUT_EFFECT_KEYS_H_

#include <map>
#include <string>
#include <vector>

#include "rollout/effects/scene_effect.h"

namespace physpring {

// In the order of their effects' names.
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
