// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/scenes/task_scene.h"

#include <fmt/format.h>

#include <utility>

#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "twin/error.h"

namespace physpring {

std::shared_ptr<const TaskAtLevel> LoadTask(const std::string& folder, int level,
                                            PictureQuality quality, int width, int height) {
  ExpectMujoco();
  LoadPluginLibrary();
  const auto loaded = std::make_shared<TaskAtLevel>();
  loaded->task = ReadTask(folder);
  if (width > 0) loaded->task.width = width;
  if (height > 0) loaded->task.height = height;
  loaded->quality = quality;
  loaded->model = MakeTaskModel(loaded->task, level, &loaded->warnings);
  PreparePictures(quality, loaded->task.width, loaded->task.height, loaded->model.model.get());
  return loaded;
}

TaskScene::TaskScene(std::shared_ptr<const TaskAtLevel> task)
    : task_(std::move(task)), simulation_(task_->model) {}

void TaskScene::Begin(const EpisodeStart& start) {
  result_ = {};
  result_.episode.start = start;
  result_.episode.level = task_->model.level;
  policy_.reset();
  episode_.reset();  // where it does not begin, there is none
  SteppedEpisode episode(task_->model, &simulation_, &result_);
  episode.Begin();
  episode_.emplace(std::move(episode));
}

void TaskScene::Reset(std::uint64_t seed, int episode, const Disturbance& disturbance) {
  if (episode < 0) throw Error(fmt::format("episode is {}, expected 0 or more", episode));
  Begin(StartOf(task_->task, seed, episode, disturbance));
}

void TaskScene::ResetAt(const Pose& object, std::uint64_t seed) {
  EpisodeStart start;
  start.seed = seed;
  start.object = object;
  Begin(start);
}

const SteppedEpisode& TaskScene::episode() const {
  if (episode_) return *episode_;
  throw Error("no episode has begun: reset() comes before step()");
}

void TaskScene::ExpectStep(const Eigen::VectorXd& action) const {
  if (episode().over()) throw Error("the episode is over: reset() begins another one");
  ExpectAction(action, task_->task.robot);
}

void TaskScene::Step(const Eigen::VectorXd& action) {
  ExpectStep(action);
  episode_->Step(action);
}

std::map<std::string, Image> TaskScene::Look() {
  static_cast<void>(episode());
  if (!viewer_) viewer_ = MakeCameraThread(task_->model, {task_->quality, "", {}});
  return viewer_->Look(simulation_.data());
}

Eigen::VectorXd TaskScene::Act(const std::string& policy) {
  Observation observation = episode().observation();
  if (!policy_ || policy_name_ != policy) {
    const EpisodeStart& start = result_.episode.start;
    policy_ = MakePolicy(task_->task, {policy, {}}, task_->model.level, start.episode);
    policy_->Reset(start.seed);
    policy_name_ = policy;
  }
  if (policy_->NeedsImages()) observation.images = Look();
  return policy_->Act(observation);
}

}  // namespace physpring
