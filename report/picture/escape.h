// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_REPORT_PICTURE_ESCAPE_H_
#define PHYSPRING_REPORT_PICTURE_ESCAPE_H_

#include <string>

namespace physpring {

// Text as HTML shows it, in elements and in quoted attributes.
std::string Escape(const std::string& text);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_ESCAPE_H_
