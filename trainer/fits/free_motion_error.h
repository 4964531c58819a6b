// SPDX-License-Identifier: Apache-2.0
// By what the fit of a chain (bodies/bending_chain.h) ends: the geometric mean of the track errors
// of free motions, as a function of the chain's common factors. Those of a cable that whirls are
// chaotic: small differences and adjoints of them tell little, values and long differences more.
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

  // m; infinite where it diverges or would need too many sub-steps.
  double operator()(const Eigen::VectorXd& factors) const;

 private:
  Parameters factors_;
  MotionProblem::Options follow_;
  LiftedMotion motion_;  // for its sub-steps
  std::vector<Episode> episodes_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FREE_MOTION_ERROR_H_
