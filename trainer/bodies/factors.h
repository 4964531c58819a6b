// SPDX-License-Identifier: Apache-2.0
// How a body is set up to be fitted: which factors move, their priors, and the problem of following
// the recordings.
#ifndef PHYSPRING_TRAINER_BODIES_FACTORS_H_
#define PHYSPRING_TRAINER_BODIES_FACTORS_H_

#include "trainer/bodies/parameters.h"
#include "trainer/bodies/spring_net.h"
#include "trainer/data/train_options.h"
#include "trainer/motion/motion_problem.h"
#include "trainer/solvers/gauss_newton.h"

namespace physpring {

// The factors that all springs share (parameters.h), those of the ground where there is one, and
// what the kind of body adds.
Parameters CommonFactors(const SpringMassSystem& base, const Recording& recording,
                         const BodyKind& kind = SpringNet());

// The same factors and every spring's own stiffness, dashpot and rest length, and their prior.
Parameters SpringFactors(const SpringMassSystem& base, const Recording& recording,
                         const BodyKind& kind = SpringNet());
GaussNewtonOptions SpringPrior(const Parameters& parameters);
constexpr int kMostSpringRecordings = 12;  // that single springs are fitted to

// Steps of differences in the log-factors: of one common factor, and the longest entry of a step
// along all parameters. Contacts make residuals jump, and floats are coarse: both want longer ones.
double FactorDifference(const Recording& recording);
double DirectionDifference(const Recording& recording, bool single_precision);

// No stiffness is taken that would need more than 10,000 sub-steps a second (half of PhysTwin's);
// for common factors half of that, so that single springs find room.
MotionProblem::Options FollowOptions(const Recording& recording, const Body& body,
                                     const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_FACTORS_H_
