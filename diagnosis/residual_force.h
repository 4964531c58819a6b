// SPDX-License-Identifier: Apache-2.0
// The residual of a twin as forces: the smallest ones, constant during each frame, with which the
// twin, followed by an observer (trainer/motion/observer.h), predicts the measured motion. They say
// where, when and in which direction the model lacks something, before any effect is named.
//
// r are the distances of measured from predicted points. J are their derivatives with respect to
// kicks of the velocities at the frames (f T / m for a force f during a frame of T seconds). Each
// step takes kicks s towards the least |r - J s|^2 by conjugate gradients on the normal equations
// (CGLS). It stops when the mean square of what is left comes to the measurements' variance (the
// discrepancy principle: Hanke, Conjugate Gradient Type Methods for Ill-Posed Problems, 1995). The
// kicks then hold no more than the data demand; they are too small rather than too large. Without
// the observer, J of a motion that swings freely is so large in a few directions that nothing else
// is found. The observer forgets what is three frames ago.
#ifndef PHYSPRING_DIAGNOSIS_RESIDUAL_FORCE_H_
#define PHYSPRING_DIAGNOSIS_RESIDUAL_FORCE_H_

#include <vector>

#include "twin/recording.h"
#include "twin/spring_mass_system.h"

namespace physpring {

struct ResidualForce {
  std::vector<Points> force;     // N, for each step from frame to frame: 3 x nodes
  std::vector<Points> position;  // m, in each frame with these forces: 3 x nodes
  // For each node, N: the standard deviation of a coordinate of the force that the noise of the
  // measurements alone would make.
  Eigen::VectorXd noise;
  double left = 0;  // root mean square of a measured coordinate's residual with these forces, m
  // Whether they explain the residuals: what is left is near the noise, or less than half of what
  // was there. Otherwise they are no finding.
  bool converged = true;
};

struct ResidualForceOptions {
  bool controller_velocity = true;
  int substeps = 1;          // sub-steps a frame
  double deviation = 0;      // standard deviation of a measured coordinate, m
  double difference = 1e-5;  // longest entry of the step of J v; longer where contacts jump
};

// Throws Error if the motion diverges without forces.
ResidualForce FindResidualForce(const SpringMassSystem& system, const Recording& recording,
                                const ResidualForceOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_RESIDUAL_FORCE_H_
