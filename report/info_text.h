// SPDX-License-Identifier: Apache-2.0
// What is in a recording or a twin, to read (lines, each ending with a newline) and as JSON with
// the units in its keys.
#ifndef PHYSPRING_REPORT_INFO_TEXT_H_
#define PHYSPRING_REPORT_INFO_TEXT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

std::string DescribeRecording(const Recording& recording);
nlohmann::ordered_json RecordingToJson(const Recording& recording);

// What is known of the scale of masses and stiffnesses, and of the clocks: lines to read.
std::string DescribeScales(const Twin& twin);

std::string DescribeTwin(const Twin& twin);
nlohmann::ordered_json TwinToJson(const Twin& twin);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_INFO_TEXT_H_
