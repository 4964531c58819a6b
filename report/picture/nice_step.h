// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_REPORT_PICTURE_NICE_STEP_H_
#define PHYSPRING_REPORT_PICTURE_NICE_STEP_H_

#include <cmath>

namespace physpring {

// The least of ... 0.1, 0.2, 0.5, 1, 2, 5, 10 ... that is at least `least` (> 0): for axes and
// scales.
inline double NiceStep(double least) {
  const double decade = std::pow(10, std::floor(std::log10(least)));
  for (double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  }
  return 10 * decade;
}

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_NICE_STEP_H_
