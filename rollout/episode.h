// SPDX-License-Identifier: Apache-2.0
// One episode: a policy drives a simulation from its start for the task's frames, and everything
// that happens is kept.
#ifndef PHYSPRING_ROLLOUT_EPISODE_H_
#define PHYSPRING_ROLLOUT_EPISODE_H_

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rollout/policy.h"
#include "rollout/simulation.h"

namespace physpring {

// Cameras, for policies that see and for videos.
class Viewer {
 public:
  virtual ~Viewer() = default;

  // The state as the next picture of the video. May return before it is drawn.
  virtual void Show(const mjData& data) = 0;

  // What the task's cameras see, by their names.
  virtual std::map<std::string, Image> Look(const mjData& data) = 0;

  // The video is complete.
  virtual void Finish() = 0;

  virtual double seconds() const = 0;  // spent on drawing so far
};

struct TaskEpisode {
  EpisodeStart start;
  int level = 0;
  bool success = false;
  int met_frames = 0;   // that count, see SuccessOptions
  std::string problem;  // why the episode ended early, or empty

  // One a frame, and for states one more: before the first frame.
  std::vector<Eigen::VectorXd> actions;  // as the policy gave them, with the start's offset
  std::vector<double> value;             // SuccessRule::Verdict::value after the frame
  std::vector<Eigen::VectorXd> robot;
  std::vector<Points> nodes;  // where the level's nodes are, m
};

// How long it took, s: not the same the next time, so kept apart.
struct EpisodeSeconds {
  double physics = 0, policy = 0, scoring = 0;
  double rendering = 0;  // drawing, in whatever thread
  double total = 0;      // wall clock
};

struct EpisodeResult {
  TaskEpisode episode;
  EpisodeSeconds seconds;
  bool stopped = false;  // before its end; the rest is worth nothing then
};

// `viewer` may be null where the policy needs no images. A policy that fails (PolicyError), gives
// wrong or not finite numbers, and a simulation that becomes unstable, end the episode with a
// `problem` and without success. `stop`, if there is one, is asked before each frame.
EpisodeResult RunEpisode(const TaskModel& model, const EpisodeStart& start, Simulation* simulation,
                         Policy* policy, Viewer* viewer,
                         const std::function<bool()>& stop = nullptr);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EPISODE_H_
