// SPDX-License-Identifier: Apache-2.0
// A body (bodies/body.h) with values of its common factors, and how these are fitted.
#ifndef PHYSPRING_TRAINER_BODIES_CHOSEN_BODY_H_
#define PHYSPRING_TRAINER_BODIES_CHOSEN_BODY_H_

#include <Eigen/Core>
#include <vector>

#include "trainer/bodies/factors.h"
#include "trainer/solvers/levenberg_marquardt.h"

namespace physpring {

struct ChosenBody {
  Body body;
  double start_substeps = 0;
  Eigen::VectorXd start, factors;  // the common factors at first and as fitted

  Parameters ParametersOf(const Recording& recording) const;
  SpringMassSystem System(const Recording& recording) const;
  // The same with the other treatment of the controllers' velocity.
  ChosenBody WithOtherVelocity() const;
  // The same with the other cone of friction.
  ChosenBody WithOtherCone() const;
  // The same with springs beyond its radius, where it may have any (body.h). Factors of its classes
  // of length are left out: the classes of more springs are others.
  ChosenBody WithSoftSprings(const Recording& recording) const;
};

// One step of Levenberg-Marquardt on common factors, under an observer of this gain.
LevenbergMarquardtState StepFactors(const ChosenBody& model, const std::vector<Episode>& episodes,
                                    const TrainOptions& options, double gain, double damping);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_CHOSEN_BODY_H_
