// SPDX-License-Identifier: Apache-2.0
#include "rollout/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "rollout/make_policy.h"
#include "rollout/sweep_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/output_lock.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

struct Job {
  int episode = 0;
  const TaskModel* model = nullptr;
};

// What the threads share.
class Queue {
 public:
  Queue(const Task& task, const SweepOptions& options, const SweepHooks& hooks,
        std::vector<Job> jobs, int finished, Sweep* sweep)
      : task_(task),
        options_(options),
        hooks_(hooks),
        jobs_(std::move(jobs)),
        finished_(finished),
        sweep_(*sweep) {}

  void Run() {
    const auto count = std::min<std::size_t>(std::max(1, options_.threads), jobs_.size());
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < count; ++i) threads.emplace_back([this] { Work(); });
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  // Jobs until there are none, or one of the threads failed.
  void Work() {
    std::map<int, Simulation> simulations;  // by level
    try {
      for (std::size_t i = next_++; i < jobs_.size() && !stopped_; i = next_++) {
        if (hooks_.stop && hooks_.stop()) {
          Stop();
          return;
        }
        const Job& job = jobs_[i];
        auto simulation = simulations.find(job.model->level);
        if (simulation == simulations.end()) {
          simulation = simulations.try_emplace(job.model->level, *job.model).first;
        }
        RunJob(job, &simulation->second);
      }
    } catch (const Stopped&) {
      Stop();
    } catch (...) {
      stopped_ = true;
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }

  void Stop() {
    stopped_ = true;
    const std::lock_guard lock(mutex_);
    sweep_.complete = false;
  }

  void RunJob(const Job& job, Simulation* simulation) {
    const EpisodeStart start = StartOf(task_, options_.seed, job.episode, options_.disturbance);
    const std::unique_ptr<Policy> policy =
        MakePolicy(task_, options_.policy, job.model->level, job.episode);
    std::unique_ptr<Viewer> viewer;
    if (hooks_.make_viewer) {
      viewer = hooks_.make_viewer(*job.model, job.episode, policy->NeedsImages());
    }
    const EpisodeResult result = RunOrFail(job, start, simulation, policy.get(), viewer.get());
    if (result.stopped) {
      Stop();
      return;
    }
    if (!options_.folder.empty()) WriteEpisode(options_.folder, result, options_.states);
    const std::lock_guard lock(mutex_);
    sweep_.episodes.push_back(Summarise(result));
    ++finished_;
    if (hooks_.report) {
      hooks_.report(sweep_.episodes.back(), finished_,
                    sweep_.skipped + static_cast<int>(jobs_.size()));
    }
  }

  // A server that fails stops the sweep: an episode without it says nothing of the policy.
  EpisodeResult RunOrFail(const Job& job, const EpisodeStart& start, Simulation* simulation,
                          Policy* policy, Viewer* viewer) const {
    try {
      return RunEpisode(*job.model, start, simulation, policy, viewer, hooks_.stop);
    } catch (const PolicyServerError& error) {
      throw Error(fmt::format("{}; episode {} is not judged{}", error.what(), job.episode,
                              options_.folder.empty() ? "" : ", what was finished is kept"));
    }
  }

  const Task& task_;
  const SweepOptions& options_;
  const SweepHooks& hooks_;
  const std::vector<Job> jobs_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;  // guards what follows
  int finished_;
  Sweep& sweep_;
  std::exception_ptr failure_;
};

// An episode that need not be run again. Where its files are damaged, says so and finds none.
std::optional<EpisodeSummary> FindFinished(const std::string& folder, int level, int episode,
                                           std::vector<std::string>* warnings) {
  if (folder.empty()) return std::nullopt;
  try {
    return ReadEpisode(folder, level, episode);
  } catch (const Error& error) {
    warnings->push_back(std::string(error.what()) + "; the episode is run again");
    return std::nullopt;
  }
}

}  // namespace

Sweep RunSweep(const Task& task, const SweepOptions& options, const SweepHooks& hooks) {
  Sweep sweep;
  std::vector<TaskModel> models;
  std::map<int, std::string> hashes;
  for (const int level : options.levels) {
    models.push_back(MakeTaskModel(task, level, &sweep.warnings));
    hashes[level] = HashModel(*models.back().model);
    if (hooks.prepare) hooks.prepare(models.back().model.get());
  }
  std::optional<OutputLock> lock;
  if (!options.folder.empty()) {
    MakeFolder(options.folder);
    lock.emplace(options.folder);
    OpenSweepFolder(task, options, hashes);
  }

  std::vector<Job> jobs;
  for (int i = options.shard - 1; i < options.episodes; i += options.shards) {
    for (const TaskModel& model : models) {
      const int episode = options.first + i;
      const auto finished = FindFinished(options.folder, model.level, episode, &sweep.warnings);
      if (finished) {
        sweep.episodes.push_back(*finished);
      } else {
        jobs.push_back({episode, &model});
      }
    }
  }
  sweep.skipped = static_cast<int>(sweep.episodes.size());
  Queue(task, options, hooks, std::move(jobs), sweep.skipped, &sweep).Run();
  std::sort(sweep.episodes.begin(), sweep.episodes.end(), [](const auto& a, const auto& b) {
    return std::pair(a.episode, a.level) < std::pair(b.episode, b.level);
  });
  return sweep;
}

}  // namespace physpring
