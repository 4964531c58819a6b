// SPDX-License-Identifier: Apache-2.0
// A model (fit_model.h) with values of its common factors, and how these are fitted.
#ifndef PHYSPRING_TRAINER_CHOSEN_MODEL_H_
#define PHYSPRING_TRAINER_CHOSEN_MODEL_H_

#include <Eigen/Core>
#include <vector>

#include "trainer/fit_model.h"
#include "trainer/levenberg_marquardt.h"

namespace physpring {

struct ChosenModel {
  Candidate candidate;
  double start_substeps = 0;
  Eigen::VectorXd start, factors;  // at first and as fitted

  Parameters Factors(const Recording& recording) const;
  SpringMassSystem System(const Recording& recording) const;
};

// One step of Levenberg-Marquardt on common factors, under an observer of this gain.
LevenbergMarquardtState StepFactors(const ChosenModel& model, const std::vector<Episode>& episodes,
                                    const TrainOptions& options, double gain, double damping);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_CHOSEN_MODEL_H_
