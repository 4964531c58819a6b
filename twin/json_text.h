// SPDX-License-Identifier: Apache-2.0
// The one way by which JSON text becomes values. Files may be hostile: what is too long, too deep
// or too much is refused while it is read, before it fills the memory, or the stack of whoever
// walks through it. So is a key that an object has twice: one of both would be lost. Messages are
// one line and quote little.
#ifndef PHYSPRING_TWIN_JSON_TEXT_H_
#define PHYSPRING_TWIN_JSON_TEXT_H_

#include <nlohmann/json.hpp>
#include <string>

namespace physpring {

// The most that is read: far more than any file of ours has.
struct JsonLimits {
  static constexpr std::size_t kBytes = std::size_t{1} << 22;
  static constexpr std::size_t kDepth = 32;
  static constexpr int kValues = 1 << 18;  // in the whole text
  static constexpr int kKeys = 1000;       // of one object: they are searched one by one
};

// Parses `text`. Throws Error, "WHERE: ...", unless it is JSON within the limits.
nlohmann::ordered_json ParseJson(const std::string& text, const std::string& where);

// `value` as compact JSON in quotes, shortened as Quote does.
std::string QuoteJson(const nlohmann::ordered_json& value);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_JSON_TEXT_H_
