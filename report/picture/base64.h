// SPDX-License-Identifier: Apache-2.0
// Bytes as text, for pages that need no other file.
#ifndef PHYSPRING_REPORT_PICTURE_BASE64_H_
#define PHYSPRING_REPORT_PICTURE_BASE64_H_

#include <string>
#include <string_view>

namespace physpring {

std::string Base64(std::string_view bytes);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_BASE64_H_
