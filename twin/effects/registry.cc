// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/registry.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "twin/effects/list.h"
#include "twin/error.h"

namespace physpring {

#define PHYSPRING_DECLARE(NAME) std::unique_ptr<Effect> Make##NAME();
PHYSPRING_EFFECTS(PHYSPRING_DECLARE, PHYSPRING_NO_EFFECT, PHYSPRING_DECLARE)
#undef PHYSPRING_DECLARE

namespace {

std::vector<std::unique_ptr<Effect>> MakeAll() {
  std::vector<std::unique_ptr<Effect>> effects;
#define PHYSPRING_MAKE(NAME) effects.push_back(Make##NAME());
  PHYSPRING_EFFECTS(PHYSPRING_MAKE, PHYSPRING_NO_EFFECT, PHYSPRING_MAKE)
#undef PHYSPRING_MAKE
  return effects;
}

}  // namespace

const std::vector<const Effect*>& AllEffects() {
  static const std::vector<std::unique_ptr<Effect>> kEffects = MakeAll();
  static const std::vector<const Effect*> kPointers = [] {
    std::vector<const Effect*> pointers;
    for (const auto& effect : kEffects) pointers.push_back(effect.get());
    return pointers;
  }();
  return kPointers;
}

const Effect* FindEffect(const std::string& name) {
  for (const Effect* effect : AllEffects()) {
    if (effect->name() == name) return effect;
  }
  return nullptr;
}

const Effect& GetEffect(const std::string& name) {
  if (const Effect* effect = FindEffect(name)) return *effect;
  std::string known;
  for (const Effect* effect : AllEffects()) known += ", " + effect->name();
  throw Error(fmt::format("there is no effect '{}', expected one of {}", name, known.substr(2)));
}

void ValidateEffect(const EffectValues& effect, const std::string& where) {
  const Effect* const known = FindEffect(effect.name);
  if (!known) throw Error(fmt::format("{}: there is no effect '{}'", where, effect.name));
  if (effect.values.size() != known->value_count()) {
    throw Error(fmt::format("{}: effect {} has {} values, expected {}", where, effect.name,
                            effect.values.size(), known->value_count()));
  }
  Eigen::Index i = 0;
  for (const EffectParameter& parameter : known->parameters()) {
    for (int n = 0; n < parameter.count; ++n, ++i) {
      const double value = effect.values[i];
      if (std::isfinite(value) && value >= parameter.low && value <= parameter.high) continue;
      throw Error(fmt::format("{}: {} of effect {} is {}, expected {} to {}", where, parameter.key,
                              effect.name, value, parameter.low, parameter.high));
    }
  }
}

}  // namespace physpring
