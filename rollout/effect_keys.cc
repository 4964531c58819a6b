// SPDX-License-Identifier: Apache-2.0
#include "rollout/effect_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "rollout/effects/registry.h"
#include "twin/error.h"

namespace physpring {
namespace {

const EffectKey& Find(const std::string& name) {
  const std::vector<EffectKey>& keys = EffectKeys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const EffectKey& key) { return key.name == name; });
  if (found != keys.end()) return *found;
  // those of the effect, or with the word, that is given; else all effects
  std::vector<std::string> near, effects;
  for (const EffectKey& key : keys) {
    const bool has_word = !name.empty() && key.name.find(name) != std::string::npos;
    if (has_word || key.effect() == name.substr(0, name.find('.'))) near.push_back(key.name);
    if (effects.empty() || effects.back() != key.effect()) effects.push_back(key.effect());
  }
  throw Error(fmt::format("there is no effect '{}', but {}", name,
                          fmt::join(near.empty() ? effects : near, ", ")));
}

std::string Bounds(const EffectKey& key) {
  return fmt::format("{} takes a number from {} to {}", key.name, key.low, key.high);
}

}  // namespace

const std::vector<EffectKey>& EffectKeys() {
  static const std::vector<EffectKey> kKeys = [] {
    std::vector<const SceneEffect*> effects = AllSceneEffects();
    std::sort(effects.begin(), effects.end(),
              [](const auto* p, const auto* q) { return p->name() < q->name(); });
    std::vector<EffectKey> keys;
    for (const SceneEffect* effect : effects) {
      for (EffectKey key : effect->keys()) {
        key.name = effect->name() + "." + key.name;
        keys.push_back(key);
      }
    }
    return keys;
  }();
  return kKeys;
}

std::pair<std::string, double> ParseEffect(const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const EffectKey& key = Find(text.substr(0, equals));
  const std::string number = equals < text.size() ? text.substr(equals + 1) : "";
  double value = 0;
  const char* end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, value);
  if (number.empty() || error != std::errc() || stop != end || !(value >= key.low) ||
      !(value <= key.high)) {
    throw Error(fmt::format("{}, not '{}'", Bounds(key), number));
  }
  return {key.name, value};
}

void ExpectEffects(const SceneEffects& effects) {
  for (const auto& [name, value] : effects) {
    const EffectKey& key = Find(name);
    if (!(value >= key.low && value <= key.high)) {
      throw Error(fmt::format("{}, not {}", Bounds(key), value));
    }
    std::string amounts;
    bool given = false;
    for (const EffectKey& other : EffectKeys()) {
      if (other.effect() != key.effect() || !other.amount) continue;
      amounts += (amounts.empty() ? "" : " or ") + other.name;
      given |= effects.contains(other.name);
    }
    if (!given) throw Error(fmt::format("{} needs {}, too", name, amounts));
  }
}

}  // namespace physpring
