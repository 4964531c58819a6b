// SPDX-License-Identifier: Apache-2.0
// README.md of an exported twin: what it is, what made it, and how it is used.
#ifndef PHYSPRING_EXPORTER_README_H_
#define PHYSPRING_EXPORTER_README_H_

#include <string>
#include <vector>

#include "exporter/export.h"

namespace physpring {

// `levels`: at least one, all of one twin.
std::string FormatReadme(const std::vector<ExportedLevel>& levels, const std::string& command);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_README_H_
