// SPDX-License-Identifier: Apache-2.0
#include "jobs/train_options_json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "jobs/train_option_list.h"
#include "trainer/reduction/registry.h"
#include "twin/effects/effect_json.h"
#include "twin/error.h"
#include "twin/json_text.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

// "network-epochs" is network_epochs.
std::string KeyOf(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

class JsonVisitor {
 public:
  static bool all() { return false; }

  template <class Value, std::size_t kCount>
  void Choice(const char* name, const Value* value, const Word<Value> (&words)[kCount],
              const char* /*help*/) {
    json[KeyOf(name)] = WordOf(words, *value);
  }
  void Reduction(const char* name, const std::string* reduction, const char* /*help*/) {
    json[KeyOf(name)] = *reduction;
  }
  void Count(const char* name, const int* count, int /*least*/, int /*most*/,
             const char* /*help*/) {
    json[KeyOf(name)] = *count;
  }
  void CountOrAuto(const char* name, const int* count, const char* /*help*/) {
    json[KeyOf(name)] = *count > 0 ? Json(*count) : Json("auto");
  }
  void Flag(const char* name, const bool* value, const char* /*help*/) {
    json[KeyOf(name)] = *value ? "on" : "off";
  }
  void Ratios(const char* name, const std::vector<double>* ratios, int levels,
              const char* /*help*/) {
    json[KeyOf(name)] = std::vector<double>(ratios->begin(), ratios->begin() + levels - 1);
  }
  void Neighbours(const char* name, const std::vector<int>* counts, const char* /*help*/) {
    json[KeyOf(name)] = counts->empty() ? Json("auto") : Json(*counts);
  }

  Json json;
};

// Takes the values from an object.
class ParseVisitor {
 public:
  explicit ParseVisitor(Json object) : object_(std::move(object)) {}

  static bool all() { return true; }

  template <class Value, std::size_t kCount>
  void Choice(const char* name, Value* value, const Word<Value> (&words)[kCount],
              const char* /*help*/) {
    const Json* given = Take(name);
    if (!given) return;
    std::vector<std::string> choices;
    for (const auto& [word, meaning] : words) {
      choices.emplace_back(word);
      if (*given != word) continue;
      *value = meaning;
      return;
    }
    FailChoice(name, *given, choices);
  }
  void Reduction(const char* name, std::string* reduction, const char* /*help*/) {
    const Json* given = Take(name);
    if (!given) return;
    std::vector<std::string> choices;
    for (const auto& one : AllReductions()) choices.push_back(one->name());
    const auto found =
        std::find_if(choices.begin(), choices.end(),
                     [given](const std::string& choice) { return *given == choice; });
    if (found == choices.end()) FailChoice(name, *given, choices);
    *reduction = *found;
  }
  void Count(const char* name, int* count, int least, int most, const char* /*help*/) {
    if (const Json* given = Take(name)) *count = Whole(name, *given, least, most);
  }
  void CountOrAuto(const char* name, int* count, const char* /*help*/) {
    const Json* given = Take(name);
    if (given) *count = *given == "auto" ? 0 : Whole(name, *given, 1, 1000000000);
  }
  void Flag(const char* name, bool* value, const char* /*help*/) {
    const Json* given = Take(name);
    if (!given) return;
    if (given->is_boolean()) {
      *value = given->get<bool>();
    } else if (*given == "on" || *given == "off") {
      *value = *given == "on";
    } else {
      Fail(name, *given, "true or false");
    }
  }
  void Ratios(const char* name, std::vector<double>* ratios, int /*levels*/, const char* /*help*/) {
    const Json* given = Take(name);
    if (!given) return;
    ratios->clear();
    ExpectList(name, *given);
    for (const Json& ratio : *given) {
      const double value = ratio.is_number() ? ratio.get<double>() : -1;
      if (!(value >= 0 && value <= 1)) Fail(name, ratio, "numbers from 0 to 1");
      ratios->push_back(value);
    }
  }
  void Neighbours(const char* name, std::vector<int>* counts, const char* /*help*/) {
    const Json* given = Take(name);
    if (!given) return;
    counts->clear();
    if (*given == "auto") return;
    if (given->is_number()) {
      counts->push_back(Whole(name, *given, 1, 1000));
      return;
    }
    ExpectList(name, *given);
    for (const Json& count : *given) {
      counts->push_back(Whole(name, count, 1, 1000));
    }
  }

  // Throws Error for a key that no option has.
  void ExpectAllTaken() const {
    for (const auto& [key, value] : object_.items()) {
      if (known_.contains(key)) continue;
      throw Error(fmt::format("training option {} is unknown; there are {}", Quote(key),
                              fmt::join(known_, ", ")));
    }
  }

 private:
  // What the object has of this name, or null.
  const Json* Take(const char* name) {
    const std::string key = KeyOf(name);
    known_.insert(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }
  [[noreturn]] static void Fail(const char* name, const Json& given, const std::string& expected) {
    throw Error(fmt::format("training option {} is {}, expected {}", KeyOf(name),
                            Shorten(given.dump()), expected));
  }
  [[noreturn]] static void FailChoice(const char* name, const Json& given,
                                      const std::vector<std::string>& choices) {
    Fail(name, given, fmt::format("one of {}", fmt::join(choices, ", ")));
  }
  static int Whole(const char* name, const Json& given, int least, int most) {
    const bool whole = given.is_number_integer() || given.is_number_unsigned();
    const double value = whole ? given.get<double>() : least - 1.0;
    if (!(value >= least && value <= most)) {
      Fail(name, given, fmt::format("a whole number from {} to {}", least, most));
    }
    return static_cast<int>(value);
  }
  static void ExpectList(const char* name, const Json& given) {
    if (!given.is_array() || given.empty()) Fail(name, given, "a list of numbers");
  }

  Json object_;
  std::set<std::string> known_;
};

// The reductions that learn features: "learned".
std::string FeatureReductions() {
  std::string names;
  for (const auto& reduction : AllReductions()) {
    if (reduction->LearnsFeatures()) names += (names.empty() ? "" : " or ") + reduction->name();
  }
  return names;
}

}  // namespace

std::string TrainOptionsJson(const TrainOptions& options, const std::string& from) {
  JsonVisitor visitor;
  VisitTrainOptions(options, visitor);
  Json& json = visitor.json;
  if (!from.empty()) json["from"] = from;
  if (!options.effects.empty()) {
    json["effects"] = ParseJson(EffectsToJson(options.effects), "effects");
  }
  return json.dump();
}

TrainOptions ParseTrainOptions(const std::string& json) {
  Json object = ParseJson(json, "training options");
  if (!object.is_object()) throw Error("training options: expected an object");
  ParseVisitor visitor(std::move(object));
  TrainOptions options;
  VisitTrainOptions(options, visitor);
  visitor.ExpectAllTaken();
  return options;
}

std::optional<TrainOptionsError> CheckTrainOptions(const TrainOptions& options,
                                                   const TrainSources& sources) {
  const TrainOptions defaults;
  const bool full = options.method == TrainOptions::Method::kFull;
  const bool smooth = options.method == TrainOptions::Method::kSmooth;
  const bool two_stage = options.method == TrainOptions::Method::kTwoStage;
  const std::size_t coarse = static_cast<std::size_t>(options.levels) - 1;
  const bool learned_features =
      options.network.features == TrainOptions::Network::Features::kLearned;
  const struct {
    bool wrong;
    const char* option;
    std::string why;
  } checks[] = {
      {two_stage && !options.neighbours.empty(), "neighbours", "is chosen by two-stage itself"},
      {!full && options.optimizer != defaults.optimizer, "optimizer", "is of --method full"},
      {smooth && options.epochs != 0, "epochs",
       "is not of --method smooth, which ends when it gains nothing more"},
      {options.ratios.size() < coarse, "ratios", "needs one ratio for each level but level 0"},
      {options.ratios != defaults.ratios && options.ratios.size() != coarse, "ratios",
       "are of levels 1, 2, ...: --levels must be one more than there are"},
      {options.reduction != defaults.reduction && coarse == 0, "reduction",
       "needs --levels 2 or more"},
      {!learned_features && !GetReduction(options.reduction).LearnsFeatures(), "features",
       "is of --reduction " + FeatureReductions()},
      {!learned_features && coarse == 0, "features", "needs --levels 2 or more"},
      {options.network.latent != defaults.network.latent && coarse == 0, "latent",
       "needs --levels 2 or more"},
      {two_stage && sources.effects, "effects", "is not of --method two-stage"},
      {sources.from && sources.effects, "effects",
       "and --from exclude each other: level 0 comes with its effects"},
      {!two_stage && options.self_collision, "self-collision", "is of --method two-stage"},
  };
  for (const auto& check : checks) {
    if (check.wrong) return TrainOptionsError{check.option, check.why};
  }
  return std::nullopt;
}

}  // namespace physpring
