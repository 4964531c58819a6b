// SPDX-License-Identifier: Apache-2.0
// The members of a JSON object by key, with their kinds checked. Every message is one line that
// names file, key, what it holds and what is expected.
#ifndef PHYSPRING_TWIN_JSON_FIELDS_H_
#define PHYSPRING_TWIN_JSON_FIELDS_H_

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace physpring {

class JsonFields {
 public:
  // Parses `text`, which must be one object (see json_text.h). Messages begin with `where`.
  JsonFields(const std::string& text, std::string where);

  bool Has(const std::string& key) const { return object_.contains(key); }

  std::string Text(const std::string& key) const;
  bool Flag(const std::string& key) const;
  std::uint64_t Unsigned(const std::string& key) const;
  int Count(const std::string& key) const;  // a whole number from 0 that fits an int
  double Number(const std::string& key) const;
  std::vector<double> Numbers(const std::string& key) const;     // an array of numbers
  std::vector<std::string> Texts(const std::string& key) const;  // an array of text
  std::vector<std::vector<int>> WholeNumberLists(const std::string& key) const;  // [[0, 1], ...]
  JsonFields Object(const std::string& key) const;
  std::vector<JsonFields> Objects(const std::string& key) const;  // an array of objects
  // `object` as if it stood under `key`: for what may be written shorter than as an object.
  JsonFields With(const std::string& key, nlohmann::ordered_json object) const;

  // Throws Error if there is a key that is not in `keys`.
  void ExpectOnly(std::initializer_list<std::string_view> keys) const;

  // The object with its keys in their order, also as compact text.
  const nlohmann::ordered_json& json() const { return object_; }
  std::string Dump() const { return object_.dump(); }

  // Throws Error: "WHERE: key 'KEY' WHAT".
  [[noreturn]] void Fail(const std::string& key, const std::string& what) const;

 private:
  JsonFields(nlohmann::ordered_json object, std::string where, std::string parent)
      : object_(std::move(object)), where_(std::move(where)), parent_(std::move(parent)) {}

  const nlohmann::ordered_json& Get(const std::string& key) const;
  [[noreturn]] void FailKind(const std::string& key, const std::string& expected) const;

  nlohmann::ordered_json object_;
  std::string where_;
  std::string parent_;  // before the key in messages: "recordings[3]."
};

// The one object that a file of JSON holds.
JsonFields ReadJsonFile(const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_JSON_FIELDS_H_
