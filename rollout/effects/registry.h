// SPDX-License-Identifier: Apache-2.0
// The effects that MuJoCo can simulate for a recording (twin/effects/list.h).
#ifndef PHYSPRING_ROLLOUT_EFFECTS_REGISTRY_H_
#define PHYSPRING_ROLLOUT_EFFECTS_REGISTRY_H_

#include <string>
#include <vector>

#include "rollout/effects/scene_effect.h"

namespace physpring {

const std::vector<const SceneEffect*>& AllSceneEffects();

// The effect of that name; null if there is none.
const SceneEffect* FindSceneEffect(const std::string& name);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EFFECTS_REGISTRY_H_
