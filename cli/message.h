// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_CLI_MESSAGE_H_
#define PHYSPRING_CLI_MESSAGE_H_

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace physpring {

// Says something to the user on stderr. Where nobody can read it, a full disk or a closed terminal,
// the work still goes on.
template <class... Values>
void Tell(fmt::format_string<Values...> text, Values&&... values) {
  std::fputs(fmt::format(text, std::forward<Values>(values)...).c_str(), stderr);
}

}  // namespace physpring

#endif  // PHYSPRING_CLI_MESSAGE_H_
