// SPDX-License-Identifier: Apache-2.0
#include "twin/json_text.h"

#include <fmt/format.h>

#include <string>
#include <unordered_set>
#include <vector>

#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

// Looks through a text before anything is made of it; throws Error at the first thing that is wrong
// or too many. A callback of Json::parse would do, but with one the parser goes through all that
// precedes an object in its list, at the end of each.
class JsonCounter : public nlohmann::json_sax<Json> {
 public:
  explicit JsonCounter(const std::string& where) : where_(where) {}

  bool null() override { return CountValue(); }
  bool boolean(bool) override { return CountValue(); }
  bool number_integer(number_integer_t) override { return CountValue(); }
  bool number_unsigned(number_unsigned_t) override { return CountValue(); }
  bool number_float(number_float_t, const string_t&) override { return CountValue(); }
  bool string(string_t&) override { return CountValue(); }
  bool binary(binary_t&) override { return CountValue(); }
  bool start_object(std::size_t) override { return Open(); }
  bool end_object() override { return Close(); }
  bool start_array(std::size_t) override { return Open(); }
  bool end_array() override { return Close(); }

  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second) Fail(fmt::format("has key {} twice", Quote(name)));
    if (static_cast<int>(keys_.back().size()) <= JsonLimits::kKeys) return true;
    Fail(fmt::format("has an object of more than {} keys", JsonLimits::kKeys));
  }

  bool parse_error(std::size_t byte, const std::string&, const Json::exception& error) override {
    if (dynamic_cast<const Json::out_of_range*>(&error)) Fail("has a number that is too large");
    Fail(fmt::format("is not JSON, byte {} is unexpected", byte));
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const { throw Error(where_ + ": " + what); }

  bool CountValue() {
    if (++values_ <= JsonLimits::kValues) return true;
    Fail(fmt::format("has more than {} values", JsonLimits::kValues));
  }
  bool Open() {
    keys_.emplace_back();
    if (keys_.size() <= JsonLimits::kDepth) return CountValue();
    Fail(fmt::format("is nested more than {} deep", JsonLimits::kDepth));
  }
  bool Close() {
    keys_.pop_back();
    return true;
  }

  const std::string& where_;
  std::vector<std::unordered_set<std::string>> keys_;  // of each object and list that is open
  int values_ = 0;
};

}  // namespace

Json ParseJson(const std::string& text, const std::string& where) {
  if (text.size() > JsonLimits::kBytes) {
    throw Error(fmt::format("{}: has {} bytes of JSON, expected at most {}", where, text.size(),
                            JsonLimits::kBytes));
  }
  JsonCounter counter(where);
  Json::sax_parse(text, &counter);
  return Json::parse(text);
}

std::string QuoteJson(const Json& value) {
  return Quote(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace physpring
