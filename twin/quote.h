// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_QUOTE_H_
#define PHYSPRING_TWIN_QUOTE_H_

#include <string>
#include <string_view>

namespace physpring {

// `text` in single quotes for an error message: one line whatever a damaged file holds. Control
// characters and bytes beyond ASCII are shown as '?', and a long text is cut.
std::string Quote(std::string_view text);

// The same without quotes: for numbers and JSON, which show where they begin and end.
std::string Shorten(std::string_view text);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_QUOTE_H_
