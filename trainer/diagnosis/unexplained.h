// SPDX-License-Identifier: Apache-2.0
// The pattern of what no effect explains.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_UNEXPLAINED_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_UNEXPLAINED_H_

#include <vector>

#include "trainer/diagnosis/effect_fit.h"

namespace physpring {

struct Unexplained {
  double track = 0;                      // error left above the noise floor, m
  int point = 0;                         // where it is largest ...
  Eigen::Vector3d position;              // ... its place in the reference configuration, m
  double first_time = 0, last_time = 0;  // when most of it is seen, s
  Eigen::Vector3d direction;             // mean direction of measured minus predicted there
};

// Where, when and in which direction the error of a judged fit is largest, in the first recording.
Unexplained FindUnexplained(const std::vector<SplitRecording>& recordings, const EffectFit& fit,
                            double floor);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_UNEXPLAINED_H_
