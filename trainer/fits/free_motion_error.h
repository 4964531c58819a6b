// SPDX-License-Identifier: Apache-2.0
// What the fit of a chain (bodies/bending_chain.h) makes small at its end: the geometric mean of
// the track errors of free motions, as a function of the chain's common factors. The free motions
// of a cable that whirls are chaotic. Small differences and adjoints of them tell little; values
// and long differences tell more.
#ifndef PHYSPRING_TRAINER_FITS_FREE_MOTION_ERROR_H_
#define PHYSPRING_TRAINER_FITS_FREE_MOTION_ERROR_H_

#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/motion/track_error.h"

namespace physpring {

class FreeMotionError {
 public:
  FreeMotionError(const ChosenBody& model, std::vector<Episode> episodes,
                  const TrainOptions& options);
  FreeMotionError(const FreeMotionError&) = delete;
  FreeMotionError& operator=(const FreeMotionError&) = delete;

  // The error, m; infinite where a motion diverges or would need too many sub-steps.
  double operator()(const Eigen::VectorXd& factors) const;

 private:
  Parameters factors_;
  MotionProblem::Options follow_;
  LiftedMotion motion_;  // it says how many sub-steps are needed
  std::vector<Episode> episodes_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FREE_MOTION_ERROR_H_
