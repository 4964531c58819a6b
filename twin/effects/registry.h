// SPDX-License-Identifier: Apache-2.0
// The effects there are. To add one: its file, and its line in list.h.
#ifndef PHYSPRING_TWIN_EFFECTS_REGISTRY_H_
#define PHYSPRING_TWIN_EFFECTS_REGISTRY_H_

#include <string>
#include <vector>

#include "twin/effects/effect.h"

namespace physpring {

// All effects, in the order of the list.
const std::vector<const Effect*>& AllEffects();

// The effect of that name; null if there is none.
const Effect* FindEffect(const std::string& name);

// The effect of that name; throws Error if there is none.
const Effect& GetEffect(const std::string& name);

// Throws Error, one line that begins with `where`, unless the effect is known and has as many
// values as it should, finite and within their bounds.
void ValidateEffect(const EffectValues& effect, const std::string& where);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_REGISTRY_H_
