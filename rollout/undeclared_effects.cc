// SPDX-License-Identifier: Apache-2.0
#include "rollout/undeclared_effects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "rollout/effects/registry.h"
#include "rollout/scene.h"
#include "twin/error.h"

namespace physpring {

UndeclaredEffects::UndeclaredEffects(const SceneEffects& effects, const mjModel& plain,
                                     const SoftPoints& soft, const std::string& where)
    : body_(plain, soft) {
  try {
    ExpectEffects(effects);
  } catch (const Error& error) {
    throw Error(where + ": " + error.what());
  }
  for (const SceneEffect* effect : AllSceneEffects()) {
    Given given{effect, {}};
    const std::string prefix = effect->name() + ".";
    for (const auto& [name, value] : effects) {
      if (name.starts_with(prefix)) given.amounts.Set(name.substr(prefix.size()), value);
    }
    if (given.has_amount()) given_.push_back(given);
  }
  ExpectPossible(where);
}

bool UndeclaredEffects::Given::has_amount() const {
  const std::vector<EffectKey> keys = effect->keys();
  return std::any_of(keys.begin(), keys.end(),
                     [&](const EffectKey& key) { return key.amount && amounts.At(key.name) != 0; });
}

void UndeclaredEffects::ExpectPossible(const std::string& where) const {
  std::vector<std::string> possible;
  std::string refused;
  for (const EffectKey& key : EffectKeys()) {
    const SceneEffect* effect = FindSceneEffect(key.effect());
    const auto given = std::find_if(given_.begin(), given_.end(),
                                    [&](const Given& g) { return g.effect == effect; });
    const std::string parameter = key.name.substr(key.effect().size() + 1);
    const bool is_given = given != given_.end() && given->amounts.all().contains(parameter);
    const std::string reason =
        effect->WhyNot(parameter, given != given_.end() ? given->amounts : EffectAmounts(), body_);
    if (key.amount && reason.empty()) possible.push_back(key.name);
    if (is_given && !reason.empty() && refused.empty()) {
      refused = fmt::format("{}: {}", key.name, reason);
    }
  }
  if (refused.empty()) return;
  throw Error(fmt::format("{}: cannot have the effect {}; it can have {}", where, refused,
                          fmt::join(possible, ", ")));
}

void UndeclaredEffects::Edit(mjSpec* spec) const {
  for (const auto& [effect, amounts] : given_) effect->Edit(amounts, body_, spec);
}

void UndeclaredEffects::Change(mjModel* model) const {
  bool changed = false;
  for (const auto& [effect, amounts] : given_) {
    changed |= effect->ChangeMasses(amounts, body_, model);
  }
  if (changed) {
    const DataPtr data = MakeData(*model);
    mj_setConst(model, data.get());
  }
  for (const auto& [effect, amounts] : given_) effect->Change(amounts, body_, model);
}

void UndeclaredEffects::Drive(double time, mjModel* model, mjData* data) const {
  if (time < 0) return;
  for (const auto& [effect, amounts] : given_) effect->Drive(amounts, body_, time, model);
  if (given_.empty()) return;
  for (const int carrier : body_.Carriers()) {
    std::fill_n(data->xfrc_applied + 6 * carrier, 3, 0);
  }
  for (const auto& [effect, amounts] : given_) {
    effect->AddForces(amounts, body_, time, *model, data);
  }
}

double UndeclaredEffects::latency() const {
  double sum = 0;
  for (const auto& [effect, amounts] : given_) sum += effect->Latency(amounts);
  return sum;
}

}  // namespace physpring
