// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/free_motion_error.h"

#include <algorithm>
#include <limits>

#include "trainer/bodies/factors.h"

namespace physpring {

FreeMotionError::FreeMotionError(const ChosenBody& model, std::vector<Episode> episodes,
                                 const TrainOptions& options)
    : factors_(model.ParametersOf(*episodes.at(0).recording)),
      follow_(FollowOptions(*episodes[0].recording, model.body, options)),
      motion_(episodes, follow_),
      episodes_(std::move(episodes)) {}

double FreeMotionError::operator()(const Eigen::VectorXd& factors) const {
  const SpringMassSystem system = factors_.Apply(factors);
  RolloutOptions rollout = follow_.rollout;
  const LiftedMotion::Substeps substeps = motion_.SubstepsOf(system);
  if (substeps.empty()) return std::numeric_limits<double>::infinity();
  rollout.substeps = *std::max_element(substeps.counts.begin(), substeps.counts.end());
  return GeometricTrackError(system, episodes_, FrameUse::kFit, rollout);
}

}  // namespace physpring
