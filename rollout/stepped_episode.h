// SPDX-License-Identifier: Apache-2.0
// An episode that somebody else drives, a frame at a time: the part of an episode that a policy and
// an environment have in common.
#ifndef PHYSPRING_ROLLOUT_STEPPED_EPISODE_H_
#define PHYSPRING_ROLLOUT_STEPPED_EPISODE_H_

#include "rollout/episode.h"
#include "rollout/simulation.h"

namespace physpring {

// Throws PolicyError for an action that cannot be followed: of another length, not finite, or whose
// quaternion is near zero.
void ExpectAction(const Eigen::VectorXd& action, const RobotOptions& robot);

class SteppedEpisode {
 public:
  // The model, the simulation of it and `result`, to which everything is added, live longer.
  SteppedEpisode(const TaskModel& model, Simulation* simulation, EpisodeResult* result)
      : model_(model), simulation_(*simulation), result_(*result) {}

  // Puts object and robot where the result's start has them.
  void Begin();

  // Goes on by one frame with what a policy asked for. Throws PolicyError, and changes nothing, as
  // ExpectAction does. Throws Error where the simulation is unstable.
  void Step(const Eigen::VectorXd& action);

  // What is seen now, without images.
  const Observation& observation() const { return observation_; }
  // Of the last step.
  const SuccessRule::Verdict& verdict() const { return verdict_; }
  bool counts() const { return counts_; }  // towards success, if the rule is met

  int frame() const { return observation_.frame; }
  bool over() const { return frame() >= model_.task->frames; }
  // So far.
  bool success() const { return result_.episode.met_frames >= model_.task->success.at_least; }

 private:
  void Observe(int frame);

  const TaskModel& model_;
  Simulation& simulation_;
  EpisodeResult& result_;
  Observation observation_;
  SuccessRule::Verdict verdict_;
  bool counts_ = false;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_STEPPED_EPISODE_H_
