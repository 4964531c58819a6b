// SPDX-License-Identifier: Apache-2.0
// The last part of the fit of a chain, after the search (free_motion_search.h): steepest descent of
// the shape of the rod, by long central differences of free motions (free_motion_error.h). The
// shape was fitted under an observer, where it made up for what the search has changed since.
#ifndef PHYSPRING_TRAINER_FITS_FREE_MOTION_DESCENT_H_
#define PHYSPRING_TRAINER_FITS_FREE_MOTION_DESCENT_H_

#include <limits>
#include <vector>

#include "trainer/bodies/chosen_body.h"

namespace physpring {

struct FreeMotionDescent {
  Eigen::VectorXd factors;
  double error = std::numeric_limits<double>::infinity();  // m; infinite before the first step
  bool converged = false;
};

// Makes one step from `state`, which moves the factors' `entries`. The error never grows. The
// result does not depend on options.threads.
FreeMotionDescent DescendFreeMotions(const ChosenBody& model, const std::vector<int>& entries,
                                     const std::vector<Episode>& episodes,
                                     const TrainOptions& options, const FreeMotionDescent& state);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FREE_MOTION_DESCENT_H_
