// SPDX-License-Identifier: Apache-2.0
// Names that may become those of files, folders, columns and keys.
#ifndef PHYSPRING_TWIN_PLAIN_NAME_H_
#define PHYSPRING_TWIN_PLAIN_NAME_H_

#include <algorithm>
#include <cctype>
#include <string_view>

namespace physpring {

// What IsPlainName asks for, in words.
inline constexpr char kPlainName[] = "letters, digits, '_', '-' and '.'";

inline bool IsPlainName(std::string_view name) {
  return !name.empty() && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return (c < 128 && std::isalnum(c) != 0) || c == '_' || c == '-' || c == '.';
         });
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_PLAIN_NAME_H_
