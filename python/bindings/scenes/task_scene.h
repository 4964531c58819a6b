// SPDX-License-Identifier: Apache-2.0
// A task at one level that Python steps: what an environment of Gymnasium is made of. The same code
// as an episode of `physpring rollout`, so the same states, verdicts and pictures.
#ifndef PHYSPRING_PYTHON_BINDINGS_SCENES_TASK_SCENE_H_
#define PHYSPRING_PYTHON_BINDINGS_SCENES_TASK_SCENE_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rollout/camera_thread.h"
#include "rollout/episode.h"
#include "rollout/make_policy.h"
#include "rollout/simulation.h"
#include "rollout/start.h"
#include "rollout/stepped_episode.h"
#include "rollout/task.h"
#include "rollout/task_model.h"

namespace physpring {

// A task and its compiled model, which scenes share.
struct TaskAtLevel {
  Task task;
  TaskModel model;
  std::vector<std::string> warnings;
  PictureQuality quality = PictureQuality::kFast;
  bool vary_looks = false;  // each episode has looks of its own
};

struct LoadOptions {
  PictureQuality quality = PictureQuality::kFast;
  int width = 0, height = 0;  // of pictures, pixels; 0: the task's
  bool vary_looks = false;
  std::string sample;  // folder with levels of another twin of the same nodes; empty: the task's
};

std::shared_ptr<const TaskAtLevel> LoadTask(const std::string& folder, int level,
                                            const LoadOptions& options);

class TaskScene {
 public:
  // Whether a thread works on it; guarded by the interpreter's lock.
  bool in_use = false;

  explicit TaskScene(std::shared_ptr<const TaskAtLevel> task);

  // Begins the episode of a sweep with this number. Throws Error where the scene does not settle.
  void Reset(std::uint64_t seed, int episode, const Disturbance& disturbance);
  // The same, but the object starts there.
  void ResetAt(const Pose& object, std::uint64_t seed);

  // See SteppedEpisode::Step; also refuses where no episode is under way.
  void Step(const Eigen::VectorXd& action);
  // Throws as Step does, and changes nothing.
  void ExpectStep(const Eigen::VectorXd& action) const;

  // What the task's cameras see, by their names.
  std::map<std::string, Image> Look();

  // The next action of a policy that MakePolicy knows, from the episode's beginning on. Another
  // one than before begins anew.
  Eigen::VectorXd Act(const PolicyChoice& choice);

  const TaskAtLevel& task() const { return *task_; }
  // Throws Error where no episode has begun.
  const SteppedEpisode& episode() const;
  const TaskEpisode& record() const { return result_.episode; }
  const mjData& data() const { return simulation_.data(); }

 private:
  void Begin(const EpisodeStart& start);

  std::shared_ptr<const TaskAtLevel> task_;
  Simulation simulation_;
  EpisodeResult result_;
  std::optional<SteppedEpisode> episode_;
  std::unique_ptr<Viewer> viewer_;  // from the first look on
  std::unique_ptr<Policy> policy_;
  PolicyChoice choice_;  // that made it
};

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_SCENES_TASK_SCENE_H_
