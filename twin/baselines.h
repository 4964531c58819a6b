// SPDX-License-Identifier: Apache-2.0
// Predictions that need no twin. A twin that loses to one of them is of little use.
#ifndef PHYSPRING_TWIN_BASELINES_H_
#define PHYSPRING_TWIN_BASELINES_H_

#include <string>
#include <vector>

#include "twin/linear_predictor.h"
#include "twin/recording.h"

namespace physpring {

struct Baseline {
  std::string name;               // as in tables and JSON
  std::string description;        // "a body that does not move"
  std::vector<Points> particles;  // T frames of 3 x (N+M), m
};

// motionless  all stays where it starts
// rigid       the object turns and shifts with the controllers, as a rigid body (absent without)
// linear      a regression on the controllers (linear_predictor.h; absent if `linear` is empty);
//             interior particles are those of `rigid`
std::vector<Baseline> PredictBaselines(const Recording& recording, const LinearPredictor& linear);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_BASELINES_H_
