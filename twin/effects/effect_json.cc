// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/effect_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/json_text.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

EffectValues ReadEffect(const Json& json, const std::string& where) {
  if (!json.is_object() || json.size() != 2 || !json.contains("name") ||
      !json.contains("parameters") || !json["name"].is_string()) {
    throw Error(fmt::format("{}: holds {}, expected an object of name and parameters", where,
                            QuoteJson(json)));
  }
  EffectValues effect{json["name"].get<std::string>(), {}};
  const Effect* const known = FindEffect(effect.name);
  if (!known) throw Error(fmt::format("{}: there is no effect {}", where, Quote(effect.name)));
  const Json& parameters = json["parameters"];
  if (!parameters.is_object() || parameters.size() != known->parameters().size()) {
    throw Error(fmt::format("{}: effect {} has {} parameters, expected {}", where, effect.name,
                            parameters.size(), known->parameters().size()));
  }
  std::vector<double> values;
  for (const EffectParameter& parameter : known->parameters()) {
    const auto found = parameters.find(parameter.key);
    const Json list = found == parameters.end() ? Json::array()
                      : found->is_array()       ? *found
                                                : Json::array({*found});
    if (static_cast<int>(list.size()) != parameter.count) {
      throw Error(fmt::format("{}: effect {} has {} values of {}, expected {}", where, effect.name,
                              list.size(), parameter.key, parameter.count));
    }
    for (const Json& value : list) {
      if (!value.is_number()) {
        throw Error(fmt::format("{}: {} of effect {} is {}, expected a number", where,
                                parameter.key, effect.name, QuoteJson(value)));
      }
      values.push_back(value.get<double>());
    }
  }
  effect.values = Eigen::Map<Eigen::VectorXd>(values.data(), known->value_count());
  return effect;
}

}  // namespace

std::string EffectsToJson(const std::vector<EffectValues>& effects) {
  Json list = Json::array();
  for (const EffectValues& effect : effects) {
    Json parameters = Json::object();
    Eigen::Index i = 0;
    for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
      Json values = Json::array();
      for (int n = 0; n < parameter.count; ++n) values.push_back(effect.values[i++]);
      parameters[parameter.key] = parameter.count == 1 ? values[0] : values;
    }
    list.push_back({{"name", effect.name}, {"parameters", parameters}});
  }
  return list.dump();
}

std::vector<EffectValues> EffectsFromJson(const std::string& text, const std::string& where) {
  const Json list = ParseJson(text, where);
  if (!list.is_array()) throw Error(where + ": is not a JSON list of effects");
  std::vector<EffectValues> effects;
  for (const Json& effect : list) effects.push_back(ReadEffect(effect, where));
  return effects;
}

}  // namespace physpring
