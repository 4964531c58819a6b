// SPDX-License-Identifier: Apache-2.0
// The effects of a system as JSON, for files and reports:
//   [{"name": "air_drag", "parameters": {"drag_kg_per_m": 0.1, "wind_x_m_per_s": 2, ...}}, ...]
// A parameter of several values is a list. Numbers are written so that reading gives the same bits.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_JSON_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_JSON_H_

#include <string>
#include <vector>

#include "twin/effects/effect_values.h"

namespace physpring {

std::string EffectsToJson(const std::vector<EffectValues>& effects);

// Throws Error, one line that begins with `where`, for text that EffectsToJson would not write.
std::vector<EffectValues> EffectsFromJson(const std::string& text, const std::string& where);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_JSON_H_
