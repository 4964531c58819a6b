// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/scenes/task_scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "twin/error.h"

namespace physpring {

std::shared_ptr<const TaskAtLevel> LoadTask(const std::string& folder, int level,
                                            const LoadOptions& options) {
  ExpectMujoco();
  LoadPluginLibrary();
  const auto loaded = std::make_shared<TaskAtLevel>();
  loaded->task = ReadTask(folder);
  Task& task = loaded->task;
  if (options.width > 0) task.width = options.width;
  if (options.height > 0) task.height = options.height;
  if (!options.sample.empty()) {
    for (std::string& file : task.levels) {
      const std::filesystem::path name = std::filesystem::path(file).filename();
      file = (std::filesystem::path(options.sample) / name).string();
    }
  }
  loaded->quality = options.quality;
  loaded->vary_looks = options.vary_looks;
  loaded->model = MakeTaskModel(loaded->task, level, &loaded->warnings);
  PreparePictures(options.quality, task.width, task.height, loaded->model.model.get());
  return loaded;
}

TaskScene::TaskScene(std::shared_ptr<const TaskAtLevel> task)
    : task_(std::move(task)), simulation_(task_->model) {}

void TaskScene::Begin(const EpisodeStart& start) {
  result_ = {};
  result_.episode.start = start;
  result_.episode.level = task_->model.level;
  policy_.reset();
  if (task_->vary_looks) viewer_.reset();
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
  if (!viewer_) {
    CameraOptions options{task_->quality, "", {}};
    if (task_->vary_looks) options.looks = result_.episode.start.seed;
    viewer_ = MakeCameraThread(task_->model, options);
  }
  return viewer_->Look(simulation_.data());
}

Eigen::VectorXd TaskScene::Act(const PolicyChoice& choice) {
  Observation observation = episode().observation();
  if (!policy_ || choice_.text != choice.text || choice_.adapter != choice.adapter) {
    const EpisodeStart& start = result_.episode.start;
    policy_ = MakePolicy(task_->task, choice, task_->model.level, start.episode);
    policy_->Reset(start.seed);
    choice_ = choice;
  }
  if (policy_->NeedsImages()) observation.images = Look();
  return policy_->Act(observation);
}

}  // namespace physpring
