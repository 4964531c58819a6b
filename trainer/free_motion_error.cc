// SPDX-License-Identifier: Apache-2.0
#include "trainer/free_motion_error.h"

#include <limits>

#include "trainer/factors.h"

namespace physpring {

FreeMotionError::FreeMotionError(const ChosenBody& model, std::vector<Episode> episodes,
                                 const TrainOptions& options)
    : factors_(model.ParametersOf(*episodes.at(0).recording)),
      follow_(FollowOptions(*episodes[0].recording, model.body, options)),
      problem_(factors_, episodes, follow_) {
  for (const Episode& episode : episodes) judged_.push_back({episode, episode.recording});
}

double FreeMotionError::operator()(const Eigen::VectorXd& factors) const {
  const SpringMassSystem system = factors_.Apply(factors);
  RolloutOptions rollout = follow_.rollout;
  rollout.substeps = problem_.Substeps(system);
  return rollout.substeps == 0 ? std::numeric_limits<double>::infinity()
                               : GeometricTrackError(system, judged_, rollout);
}

}  // namespace physpring
