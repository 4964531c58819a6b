// SPDX-License-Identifier: Apache-2.0
// Pictures of an object beside each other: as recorded, as predicted, and how they differ.
#ifndef PHYSPRING_REPORT_PICTURE_IMAGE_STRIP_H_
#define PHYSPRING_REPORT_PICTURE_IMAGE_STRIP_H_

#include <string>

#include "report/evaluation.h"

namespace physpring {

// HTML: the table of errors, and a <figure> for each picture in three <div class="frames">; all are
// cut to the same part, in which the object is. `evaluated` has images.
std::string FormatImageStrip(const EvaluatedRecording& evaluated);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_IMAGE_STRIP_H_
