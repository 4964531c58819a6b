// SPDX-License-Identifier: Apache-2.0
// The one entrance of JSON: nothing else parses text from a file or a model. What is nested deep
// would overflow the stack of whoever walks through it.
#ifndef PHYSPRING_TWIN_PARSE_JSON_H_
#define PHYSPRING_TWIN_PARSE_JSON_H_

#include <nlohmann/json.hpp>
#include <string>

namespace physpring {

// Throws Error, one line that begins with `where`, for what is not JSON or nested more than 32
// deep.
nlohmann::ordered_json ParseJson(const std::string& text, const std::string& where);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_PARSE_JSON_H_
