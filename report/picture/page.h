// SPDX-License-Identifier: Apache-2.0
// The picture of an evaluation: one HTML page that needs nothing else. It has a film to turn and to
// scrub through, the tables, and for each recording frames of prediction over measurement and the
// error over time.
#ifndef PHYSPRING_REPORT_PICTURE_PAGE_H_
#define PHYSPRING_REPORT_PICTURE_PAGE_H_

#include <string>

#include "report/evaluation.h"

namespace physpring {

// The page draws the first 20 recordings; its tables count them all.
std::string FormatPage(const Evaluation& evaluation);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_PAGE_H_
