// SPDX-License-Identifier: Apache-2.0
#include "twin/quote.h"

namespace physpring {

std::string Quote(std::string_view text) { return Shorten(text).insert(0, 1, '\'') + '\''; }

std::string Shorten(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string shortened;
  for (const char c : text.substr(0, kLongest)) shortened += c >= ' ' && c <= '~' ? c : '?';
  return shortened + (text.size() > kLongest ? "..." : "");
}

}  // namespace physpring
