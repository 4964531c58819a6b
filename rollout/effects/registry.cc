// SPDX-License-Identifier: Apache-2.0
#include "rollout/effects/registry.h"

#include <memory>

#include "twin/effects/list.h"

namespace physpring {

#define PHYSPRING_DECLARE(NAME) std::unique_ptr<SceneEffect> MakeScene##NAME();
PHYSPRING_EFFECTS(PHYSPRING_NO_EFFECT, PHYSPRING_DECLARE, PHYSPRING_DECLARE)
#undef PHYSPRING_DECLARE

namespace {

std::vector<std::unique_ptr<SceneEffect>> MakeAllSceneEffects() {
  std::vector<std::unique_ptr<SceneEffect>> effects;
#define PHYSPRING_MAKE(NAME) effects.push_back(MakeScene##NAME());
  PHYSPRING_EFFECTS(PHYSPRING_NO_EFFECT, PHYSPRING_MAKE, PHYSPRING_MAKE)
#undef PHYSPRING_MAKE
  return effects;
}

}  // namespace

const std::vector<const SceneEffect*>& AllSceneEffects() {
  static const std::vector<std::unique_ptr<SceneEffect>> kEffects = MakeAllSceneEffects();
  static const std::vector<const SceneEffect*> kPointers = [] {
    std::vector<const SceneEffect*> pointers;
    for (const auto& effect : kEffects) pointers.push_back(effect.get());
    return pointers;
  }();
  return kPointers;
}

const SceneEffect* FindSceneEffect(const std::string& name) {
  for (const SceneEffect* effect : AllSceneEffects()) {
    if (effect->name() == name) return effect;
  }
  return nullptr;
}

}  // namespace physpring
