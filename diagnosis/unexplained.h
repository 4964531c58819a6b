// SPDX-License-Identifier: Apache-2.0
// The pattern of what no effect explains, from the forces that are still missing. (The error of the
// prediction would not do: for a body that hangs it is largest at the free end, whatever the
// cause.)
#ifndef PHYSPRING_DIAGNOSIS_UNEXPLAINED_H_
#define PHYSPRING_DIAGNOSIS_UNEXPLAINED_H_

#include "diagnosis/residual_pattern.h"

namespace physpring {

struct Unexplained {
  double track = 0;       // error left above the noise floor, m
  bool converged = true;  // whether the search for the missing force did; else no more is known
  bool located = false;   // whether a force is missing on what was fitted; else no more is known
  int particle = 0;       // where the missing force is largest over time ...
  // ... and its place in the reference configuration, m
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double first_time = 0, last_time = 0;  // the shortest time that has half of its square, s
  // The direction of the force summed over all nodes, in the mean of that time.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double steadiness = 0;  // how steady the direction is: 1 it stays, 0 it turns to all sides alike
};

// `track`: error left above the noise floor, m.
Unexplained FindUnexplained(const ResidualPattern& missing, double track, double fps);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_UNEXPLAINED_H_
