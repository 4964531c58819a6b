// SPDX-License-Identifier: Apache-2.0
#include "twin/json_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/json_text.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

JsonFields::JsonFields(const std::string& text, std::string where)
    : object_(ParseJson(text, where)), where_(std::move(where)) {
  if (!object_.is_object()) throw Error(fmt::format("{}: is not a JSON object", where_));
}

std::string JsonFields::Text(const std::string& key) const {
  if (!Get(key).is_string()) FailKind(key, "text");
  return Get(key).get<std::string>();
}

bool JsonFields::Flag(const std::string& key) const {
  if (!Get(key).is_boolean()) FailKind(key, "true or false");
  return Get(key).get<bool>();
}

std::uint64_t JsonFields::Unsigned(const std::string& key) const {
  if (!Get(key).is_number_unsigned()) FailKind(key, "a whole number, 0 or more");
  return Get(key).get<std::uint64_t>();
}

int JsonFields::Count(const std::string& key) const {
  const std::uint64_t value = Unsigned(key);
  if (value > std::numeric_limits<int>::max()) FailKind(key, "a number below 2^31");
  return static_cast<int>(value);
}

double JsonFields::Number(const std::string& key) const {
  if (!Get(key).is_number()) FailKind(key, "a number");
  return Get(key).get<double>();
}

std::vector<double> JsonFields::Numbers(const std::string& key) const {
  const Json& array = Get(key);
  const auto is_number = [](const Json& value) { return value.is_number(); };
  if (!array.is_array() || !std::all_of(array.begin(), array.end(), is_number)) {
    FailKind(key, "an array of numbers");
  }
  return array.get<std::vector<double>>();
}

std::vector<std::string> JsonFields::Texts(const std::string& key) const {
  const Json& array = Get(key);
  const auto is_text = [](const Json& value) { return value.is_string(); };
  if (!array.is_array() || !std::all_of(array.begin(), array.end(), is_text)) {
    FailKind(key, "an array of text");
  }
  return array.get<std::vector<std::string>>();
}

std::vector<std::vector<int>> JsonFields::WholeNumberLists(const std::string& key) const {
  const auto is_whole = [](const Json& value) {
    return value.is_number_integer() && value >= std::numeric_limits<int>::min() &&
           value <= std::numeric_limits<int>::max();
  };
  const auto is_list = [&](const Json& value) {
    return value.is_array() && std::all_of(value.begin(), value.end(), is_whole);
  };
  const Json& array = Get(key);
  if (!array.is_array() || !std::all_of(array.begin(), array.end(), is_list)) {
    FailKind(key, "an array of arrays of whole numbers");
  }
  return array.get<std::vector<std::vector<int>>>();
}

JsonFields JsonFields::Object(const std::string& key) const {
  if (!Get(key).is_object()) FailKind(key, "an object");
  return JsonFields(Get(key), where_, parent_ + key + ".");
}

std::vector<JsonFields> JsonFields::Objects(const std::string& key) const {
  const Json& array = Get(key);
  const auto is_object = [](const Json& value) { return value.is_object(); };
  if (!array.is_array() || !std::all_of(array.begin(), array.end(), is_object)) {
    FailKind(key, "an array of objects");
  }
  std::vector<JsonFields> objects;
  for (const Json& object : array) {
    objects.push_back(
        JsonFields(object, where_, fmt::format("{}{}[{}].", parent_, key, objects.size())));
  }
  return objects;
}

JsonFields JsonFields::With(const std::string& key, Json object) const {
  return {std::move(object), where_, parent_ + key + "."};
}

void JsonFields::ExpectOnly(std::initializer_list<std::string_view> keys) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    Fail(key, fmt::format("is not known, expected only {}", fmt::join(keys, ", ")));
  }
}

void JsonFields::Fail(const std::string& key, const std::string& what) const {
  throw Error(fmt::format("{}: key {} {}", where_, Quote(parent_ + key), what));
}

const Json& JsonFields::Get(const std::string& key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) Fail(key, "is missing");
  return *found;
}

void JsonFields::FailKind(const std::string& key, const std::string& expected) const {
  Fail(key, fmt::format("holds {}, expected {}", QuoteJson(Get(key)), expected));
}

JsonFields ReadJsonFile(const std::string& path) {
  return JsonFields(ReadFile(path, JsonLimits::kBytes), path);
}

}  // namespace physpring
