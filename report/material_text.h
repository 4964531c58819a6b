// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_REPORT_MATERIAL_TEXT_H_
#define PHYSPRING_REPORT_MATERIAL_TEXT_H_

#include <string>
#include <vector>

#include "twin/material.h"

namespace physpring {

// What a material is, with its intervals, and what the recordings do not tell of it: lines to read,
// each ending with a newline.
std::string DescribeMaterial(const Material& material);

// What of a material the recordings do not tell to a factor of 2, in words; springs that carry
// little are left out.
std::vector<std::string> UntoldOf(const Material& material);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_MATERIAL_TEXT_H_
