// SPDX-License-Identifier: Apache-2.0
// The data of the page's film (film.js): positions in the upright frame of the view, as 16-bit
// numbers in base64.
#ifndef PHYSPRING_REPORT_PICTURE_FILM_DATA_H_
#define PHYSPRING_REPORT_PICTURE_FILM_DATA_H_

#include <string>
#include <vector>

#include "report/evaluation.h"
#include "report/picture/view.h"

namespace physpring {

// JSON of the first `views.size()` recordings, safe inside a <script>. If that would be too much
// for a page, only every second, third ... frame is in it.
std::string FormatFilmData(const Evaluation& evaluation, const std::vector<View>& views);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_FILM_DATA_H_
