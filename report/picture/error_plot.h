// SPDX-License-Identifier: Apache-2.0
// The track error over time (SVG), on a logarithmic scale: a curve for each level (lifted), and one
// for a body that does not move. Frames that were fitted are shaded.
#ifndef PHYSPRING_REPORT_PICTURE_ERROR_PLOT_H_
#define PHYSPRING_REPORT_PICTURE_ERROR_PLOT_H_

#include <string>

#include "report/evaluation.h"

namespace physpring {

// An <svg>, or a sentence if no frame has data. The attributes data-left and data-right of the svg
// give where its first and last frame are, for a <line class="cursor">.
std::string FormatErrorPlot(const EvaluatedRecording& evaluated);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_ERROR_PLOT_H_
