// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_FIT_DATA_H_
#define PHYSPRING_TRAINER_FIT_DATA_H_

#include <string>
#include <vector>

#include "trainer/fitter.h"

namespace physpring {

// Reads the recordings that `arguments` stand for (dataset.h: files, and the `fit` ones of
// folders). Those of which nothing is said count as continuous recordings of their own. Throws
// Error if one cannot be read, or naming both files if two differ in points, interior particles,
// controllers or frame rate.
FitData ReadFitData(const std::vector<std::string>& arguments);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FIT_DATA_H_
