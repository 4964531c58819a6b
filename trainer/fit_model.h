// SPDX-License-Identifier: Apache-2.0
// The models that the full fit chooses from, and how one of them is set up: its start system, what
// is fitted, and the problem of following the recordings.
#ifndef PHYSPRING_TRAINER_FIT_MODEL_H_
#define PHYSPRING_TRAINER_FIT_MODEL_H_

#include <string>
#include <vector>

#include "trainer/fitter.h"
#include "trainer/gauss_newton.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/motion_problem.h"
#include "trainer/parameters.h"
#include "trainer/train_options.h"

namespace physpring {

// One model: which particles are joined, whether dashpots feel the controllers' velocity, the cone
// of friction, and effects: those that are known, and of a rod, as one of its models, those of
// bending, whose values are fitted like common factors.
struct Candidate {
  int neighbours = 0;  // of an inner particle, about
  double radius = 0;   // m, that gives them (not used along rods)
  bool controller_velocity = true;
  FrictionCone cone = FrictionCone::kElliptic;
  std::vector<EffectValues> effects = {};
  Eigen::VectorXd mass = {};  // kg, of each particle; empty: all alike
  int free_effects = 0;       // so many effects, the last ones, are fitted

  bool is_chain() const { return free_effects > 0; }  // a rod's model that bends
  std::string Label() const;
};

// What the options leave open, in all combinations, few neighbours first. Never empty.
std::vector<Candidate> Candidates(const Recording& recording, const TrainOptions& options);

// Start systems that a fit tries, in sub-steps a frame.
constexpr double kSoftestStart = 2, kStiffestStart = 64;

// Over-damped, and as soft as `start_substeps` sub-steps a frame allow. Throws Error where the
// recording gives no body.
SpringMassSystem StartSystem(const Recording& recording, const Candidate& candidate,
                             double start_substeps);

// The factors that all springs share (parameters.h), those of the ground where there is one, and
// the values of the last `free_effects` effects.
Parameters CommonFactors(const SpringMassSystem& base, const Recording& recording,
                         int free_effects = 0);

// The same factors and every spring's own stiffness, dashpot and rest length, and their prior.
Parameters SpringFactors(const SpringMassSystem& base, const Recording& recording,
                         int free_effects = 0);
GaussNewtonOptions SpringPrior(const Parameters& parameters);
constexpr int kMostSpringRecordings = 12;  // that single springs are fitted to

// Steps of differences in the log-factors: of one common factor, and the longest entry of a step
// along all parameters. Contacts make residuals jump, and floats are coarse: both want longer ones.
double FactorDifference(const Recording& recording);
double DirectionDifference(const Recording& recording, bool single_precision);

// How the common factors of a candidate are fitted.
LevenbergMarquardtOptions FactorOptions(const Recording& recording, const Candidate& candidate);

// No stiffness is taken that would need more than 10,000 sub-steps a second (half of PhysTwin's);
// for common factors half of that, so that single springs find room.
MotionProblem::Options FollowOptions(const Recording& recording, const Candidate& candidate,
                                     const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FIT_MODEL_H_
