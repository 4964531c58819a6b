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

// What is free in the common factors of a base: the contact where there is a ground, and what the
// kind of body adds.
ParameterOptions CommonOptions(const SpringMassSystem& base, const Recording& recording,
                               const BodyKind& kind);

// The factors that all springs share (parameters.h), those of the ground where there is one, and
// what the kind of body adds.
Parameters CommonFactors(const SpringMassSystem& base, const Recording& recording,
                         const BodyKind& kind = SpringNet());

// SpringFactors adds every spring's own stiffness, dashpot and rest length to these factors.
// SpringPrior gives the prior of them all.
Parameters SpringFactors(const SpringMassSystem& base, const Recording& recording,
                         const BodyKind& kind = SpringNet());
// StiffnessFactors adds every spring's own stiffness alone; its dashpot follows.
Parameters StiffnessFactors(const SpringMassSystem& base, const Recording& recording,
                            const BodyKind& kind = SpringNet());
GaussNewtonOptions SpringPrior(const Parameters& parameters);
constexpr int kMostSpringRecordings = 12;  // single springs are fitted to no more than these

// How long the steps of differences in the log-factors are: FactorDifference for one common factor,
// DirectionDifference for the longest entry of a step along all parameters. Contacts make residuals
// jump, and floats are coarse: both want longer steps.
double FactorDifference(const Recording& recording);
double DirectionDifference(const Recording& recording, bool single_precision);

// No stiffness is taken that would need more sub-steps a second: 10,000 (half of PhysTwin's), or as
// many as the options ask for.
double MostRate(const TrainOptions& options, const Recording& recording);

// How a fit of `body` follows recordings. StepFactors (chosen_body.h) halves the most sub-steps for
// common factors, so that single springs find room.
MotionProblem::Options FollowOptions(const Recording& recording, const Body& body,
                                     const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_FACTORS_H_
