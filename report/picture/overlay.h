// SPDX-License-Identifier: Apache-2.0
// Frames of a recording as small pictures (SVG) beside each other: level 0 as predicted, in light
// lines, under the measured points, each joined to the place where it was predicted.
#ifndef PHYSPRING_REPORT_PICTURE_OVERLAY_H_
#define PHYSPRING_REPORT_PICTURE_OVERLAY_H_

#include <string>

#include "report/evaluation.h"
#include "report/picture/view.h"

namespace physpring {

// HTML: six <figure>s in a <div class="frames">, all in one scale, evenly spaced in time.
std::string FormatOverlay(const EvaluatedRecording& evaluated, const Twin& twin, const View& view);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_OVERLAY_H_
