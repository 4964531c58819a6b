// SPDX-License-Identifier: Apache-2.0
// How a body is moved towards measurements of some of its nodes. The displacements d minimise
//   sum_i p_i |r_i - d_i|^2 + sum_m (l_m q_m / e)^2,   d = sum_m f_m q_m,
// r_i: from where node i is predicted to where it is measured; p_i: the measurement's precision;
// f_m, l_m: the lowest modes and eigenvalues of the Laplacian of the springs' stiffnesses, whose
// mean diagonal is 1; e: the model's error. So what is wrong with a prediction varies smoothly
// along the body, as forces that the model lacks make it vary, and nodes that nothing is known of
// move along. Eigenvalues count by their square: without it, a dent would be drawn about each
// measured node. Controllers do not move.
#ifndef PHYSPRING_TRACKER_SMOOTH_CORRECTION_H_
#define PHYSPRING_TRACKER_SMOOTH_CORRECTION_H_

#include "twin/lowest_modes.h"
#include "twin/spring_mass_system.h"

namespace physpring {

class SmoothCorrection {
 public:
  // Coarse: by a quarter of the modes, in a fraction of the time.
  enum class Detail { kCoarse, kFull };

  explicit SmoothCorrection(const SpringMassSystem& system);

  // d, 3 x nodes, m. `offset`: r, 3 x nodes, m. `precision`: p, (nodes), 1/m^2, >= 0.
  // `model_error`: how far the prediction of a node is off that its neighbours are sure of, m.
  Points Solve(const Points& offset, const Eigen::VectorXd& precision, double model_error,
               Detail detail = Detail::kFull) const;

 private:
  Modes modes_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_SMOOTH_CORRECTION_H_
