// SPDX-License-Identifier: Apache-2.0
// Whether a fit has arrived: what it leaves of the measurements is then noise.
#ifndef PHYSPRING_TRAINER_MOTION_RESIDUAL_CORRELATION_H_
#define PHYSPRING_TRAINER_MOTION_RESIDUAL_CORRELATION_H_

#include <vector>

#include "trainer/motion/rollout.h"
#include "twin/fit_errors.h"

namespace physpring {

// With a body whose errors correlate less, nothing else is tried (kNoiseCorrelation of
// twin/fit_errors.h says what is noise).
inline constexpr double kSurelyNoise = 0.01;

// How much alike a free motion's errors are in a frame and in the next one: their autocorrelation
// at a lag of one frame, over all points that are seen in both, with a mean of 0 (Box and Jenkins,
// Time Series Analysis, 1976, ch. 8), each times the root of its weight. It is about 0 where the
// errors are noise of each frame, and near 1 where a wrong body causes them. So it is about the
// share of their mean square that is not noise. It is 1 where a motion diverges or too little is
// seen. options.substeps of 0 are as many as are stable.
double ResidualCorrelation(const SpringMassSystem& system, const std::vector<Episode>& episodes,
                           RolloutOptions options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_RESIDUAL_CORRELATION_H_
