// SPDX-License-Identifier: Apache-2.0
#include "rollout/camera_thread.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "rollout/looks.h"
#include "rollout/video_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr std::size_t kMostWaiting = 8;  // states, before Show waits

using Images = std::map<std::string, Image>;

// What places everything in the scene.
struct Snapshot {
  std::vector<double> qpos, mocap_pos, mocap_quat;
};

Snapshot Take(const mjModel& model, const mjData& data) {
  return {{data.qpos, data.qpos + model.nq},
          {data.mocap_pos, data.mocap_pos + 3 * model.nmocap},
          {data.mocap_quat, data.mocap_quat + 4 * model.nmocap}};
}

void Put(const Snapshot& snapshot, const mjModel& model, mjData* data) {
  std::copy(snapshot.qpos.begin(), snapshot.qpos.end(), data->qpos);
  std::copy(snapshot.mocap_pos.begin(), snapshot.mocap_pos.end(), data->mocap_pos);
  std::copy(snapshot.mocap_quat.begin(), snapshot.mocap_quat.end(), data->mocap_quat);
  PlaceForDrawing(model, data);
}

ModelPtr WithLooks(const mjModel& model, std::uint64_t seed) {
  ModelPtr copy(mj_copyModel(nullptr, &model));
  VaryLooks(seed, copy.get());
  return copy;
}

class CameraThread : public Viewer {
 public:
  CameraThread(const TaskModel& model, const CameraOptions& options)
      : task_(*model.task),
        own_(options.looks ? WithLooks(*model.model, *options.looks) : nullptr),
        model_(own_ ? *own_ : *model.model),
        options_(options) {
    for (const std::string& name : task_.cameras) cameras_.push_back(Find(name));
    std::vector<std::string> shown = options_.video_shows;
    if (shown.empty() && !task_.cameras.empty()) shown.push_back(task_.cameras.front());
    for (const std::string& name : shown) shown_.push_back(Find(name));
    if (!options_.video.empty()) {
      if (shown_.empty()) throw Error(task_.folder + "/task.json: names no cameras for a video");
      video_.emplace(options_.video, task_.width * static_cast<int>(shown_.size()), task_.height,
                     task_.rate);
    }
    if (task_.splats.any()) splats_.emplace(model);
    std::promise<void> ready;
    std::future<void> outcome = ready.get_future();
    thread_ = std::thread([this, &ready] { Work(&ready); });
    try {
      outcome.get();
    } catch (...) {
      thread_.join();
      throw;
    }
  }

  ~CameraThread() override {
    if (thread_.joinable()) End();
  }

  void Show(const mjData& data) override {
    if (!video_) return;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return jobs_.size() < kMostWaiting || failure_; });
    ThrowFailure();
    jobs_.push_back({Take(model_, data), nullptr});
    changed_.notify_all();
  }

  Images Look(const mjData& data) override {
    std::promise<Images> seen;
    std::future<Images> images = seen.get_future();
    {
      const std::lock_guard lock(mutex_);
      ThrowFailure();
      jobs_.push_back({Take(model_, data), &seen});
      changed_.notify_all();
    }
    return images.get();
  }

  void Finish() override {
    End();
    ThrowFailure();
    if (video_) video_->Finish();
  }

  double seconds() const override {
    const std::lock_guard lock(mutex_);
    return seconds_;
  }

 private:
  struct Job {
    Snapshot snapshot;
    std::promise<Images>* seen;  // null: a picture of the video
  };

  mjvCamera Find(const std::string& name) const { return FindCamera(model_, name, task_.scene); }

  void ThrowFailure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

  void End() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
      changed_.notify_all();
    }
    thread_.join();
  }

  // The thread.
  void Work(std::promise<void>* ready) {
    bool told = false;
    try {
      Painter painter(model_, options_.quality, task_.width, task_.height,
                      splats_ ? &*splats_ : nullptr);
      const DataPtr data = MakeData(model_);
      ready->set_value();
      told = true;
      while (std::optional<Job> job = Next()) {
        const auto start = std::chrono::steady_clock::now();
        Do(*job, data.get(), &painter);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        const std::lock_guard lock(mutex_);
        seconds_ += taken.count();
      }
    } catch (...) {
      if (!told) {
        ready->set_exception(std::current_exception());
        return;
      }
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      for (Job& job : jobs_) {
        if (job.seen) job.seen->set_exception(failure_);
      }
      jobs_.clear();
      changed_.notify_all();
    }
  }

  std::optional<Job> Next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !jobs_.empty() || ended_; });
    if (jobs_.empty()) return std::nullopt;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    changed_.notify_all();
    return job;
  }

  void Do(const Job& job, mjData* data, Painter* painter) {
    Put(job.snapshot, model_, data);
    if (!job.seen) {
      std::vector<Image> images;
      for (const mjvCamera& view : shown_) images.push_back(painter->Paint(data, view));
      video_->Add(SideBySide(images));
      return;
    }
    Images images;
    try {
      for (std::size_t i = 0; i < cameras_.size(); ++i) {
        images[task_.cameras[i]] = painter->Paint(data, cameras_[i]);
      }
    } catch (...) {
      return job.seen->set_exception(std::current_exception());
    }
    job.seen->set_value(std::move(images));
  }

  const Task& task_;
  const ModelPtr own_;  // with looks of its own; null: it is drawn as it is
  const mjModel& model_;
  std::optional<SplatLayer> splats_;
  const CameraOptions options_;
  std::vector<mjvCamera> cameras_, shown_;
  std::optional<VideoFile> video_;  // the thread's until it has ended
  mutable std::mutex mutex_;        // guards what follows
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool ended_ = false;
  double seconds_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Viewer> MakeCameraThread(const TaskModel& model, const CameraOptions& options) {
  return std::make_unique<CameraThread>(model, options);
}

}  // namespace physpring
