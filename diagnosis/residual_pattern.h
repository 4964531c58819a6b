// SPDX-License-Identifier: Apache-2.0
// What the residual forces of a twin (residual_force.h) go along with: place on the body, time,
// frequency, velocity and stretch. A drag shows against the velocity, a law of the springs against
// the stretch, gravity as a constant, a tether at a place, a driven cause in time or frequency.
#ifndef PHYSPRING_DIAGNOSIS_RESIDUAL_PATTERN_H_
#define PHYSPRING_DIAGNOSIS_RESIDUAL_PATTERN_H_

#include <vector>

#include "diagnosis/residual_force.h"

namespace physpring {

// Means of y in bins of x that hold equally many values.
struct BinnedMeans {
  std::vector<double> x, y;
  std::vector<double> error;  // standard errors of y
};

struct ResidualPattern {
  double root_mean_square = 0;  // the root mean square force on a node, N
  double noise = 0;             // the same for the forces that noise alone would make, N
  bool converged = true;        // ResidualForce; else nothing but `left` and `noise` is to be told
  double left = 0;    // root mean square of a measured coordinate's residual with the forces, m
  Points node;        // the nodes' places in the reference configuration, 3 x nodes, m
  Points mean_force;  // the mean over time on each node, N
  Eigen::VectorXd node_force;     // root mean square over time, on each node, N
  Points net;                     // 3 x steps of a frame: the sum over the nodes, N
  std::vector<double> over_time;  // root mean square over the nodes, each step of a frame, N
  std::vector<double> spectrum;   // amplitude of the sum over nodes at k / duration, k >= 1, N
  double frequency_step = 0;      // 1 / duration, Hz
  BinnedMeans along_body;         // root mean square against the body's coordinate, 0 to 1, N
  BinnedMeans against_speed;      // along the velocity, N, against the speed, m/s
  BinnedMeans against_stretch;    // towards stretched springs, N, against the stretch
  // Cosines between the forces of all nodes and frames and the velocities, or the stretch.
  double with_velocity = 0, with_stretch = 0;
  // Part of the forces' square that one acceleration, the same everywhere and always, makes up.
  double constant = 0;
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // this acceleration, m/s^2
};

ResidualPattern PatternOf(const ResidualForce& residual, const SpringMassSystem& system,
                          double fps);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_RESIDUAL_PATTERN_H_
