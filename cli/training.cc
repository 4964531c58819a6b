// SPDX-License-Identifier: Apache-2.0
#include "cli/training.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/training_hint.h"
#include "trainer/fits/train.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

// To the part of this name; a new one comes last.
void AddTime(const std::string& part, double seconds,
             std::vector<std::pair<std::string, double>>* parts) {
  const auto same = [&](const auto& one) { return one.first == part; };
  auto found = std::find_if(parts->begin(), parts->end(), same);
  if (found == parts->end()) found = parts->emplace(parts->end(), part, 0);
  found->second += seconds;
}

// A run in progress: what its journal calls.
class Running {
 public:
  Running(const TrainOptions& options, const Checkpoint& checkpoint, double interval,
          Journal* journal, TrainingRun* run)
      : options_(options),
        checkpoint_(checkpoint),
        interval_(interval),
        journal_(*journal),
        run_(*run) {
    journal->progress = [this](double share, const std::string& status) { Begin(share, status); };
    journal->kept = [this](const Journal::Piece& piece) { End(piece); };
    journal->reached = [this](const Twin& twin) { so_far_ = twin; };
  }

  int signal() const { return interrupt_.signal(); }

  void WriteUnfinished() {
    const Stopwatch writing;
    run_.twin = checkpoint_.Write(so_far_, journal_);
    Written(writing.seconds());
  }
  void WriteFinished(const Twin& twin) {
    const Stopwatch writing;
    run_.twin = checkpoint_.WriteFinished(twin);
    Written(writing.seconds());
    run_.parts.emplace_back("writing checkpoints", checkpoint_seconds_);
  }

 private:
  // Before a step.
  void Begin(double share, const std::string& status) {
    StopIfRequested();
    if (!progress_) progress_.emplace(share);
    progress_->Show(share, status);
    if (hinted_) return;
    const std::string hint =
        HintIfLong(options_, progress_->seconds(), progress_->SecondsLeft(share));
    hinted_ = !hint.empty();
    if (hinted_) progress_->Say(hint);
  }
  // After a step.
  void End(const Journal::Piece& piece) {
    AddTime(piece.name, since_step_.seconds(), &run_.parts);
    run_.share = piece.share;
    run_.status = piece.status;
    spdlog::info("{:5.1f} %  {}", 100 * piece.share, piece.status);
    if (since_checkpoint_.seconds() >= interval_) {
      WriteUnfinished();
      since_checkpoint_ = Stopwatch();
    }
    since_step_ = Stopwatch();
  }
  void Written(double seconds) {
    checkpoint_seconds_ += seconds;
    spdlog::info("checkpoint written in {:.2f} s", seconds);
  }

  const InterruptWatch interrupt_;
  const TrainOptions& options_;
  const Checkpoint& checkpoint_;
  double interval_;
  Journal& journal_;
  TrainingRun& run_;
  Twin so_far_;
  std::optional<Progress> progress_;  // from the first step on that is not in the checkpoint
  bool hinted_ = false;
  Stopwatch since_step_, since_checkpoint_;
  double checkpoint_seconds_ = 0;
};

}  // namespace

TrainingRun RunTraining(const TrainingTask& task, const Checkpoint& checkpoint, bool resume,
                        double interval) {
  Journal journal;
  TrainingRun run;
  if (resume) {
    const std::optional<Twin> before = checkpoint.Resume(&journal);
    if (before && IsFinished(*before)) {
      run.twin = *before;
      return run;
    }
  }
  Running running(task.options, checkpoint, interval, &journal, &run);
  try {
    const Work work(&journal, checkpoint.Key());
    running.WriteFinished(Train(task.data, task.options, task.dense, work));
  } catch (const Stopped&) {
    run.signal = running.signal();
    running.WriteUnfinished();
  }
  return run;
}

std::vector<std::string> WarnOfUnjoinedControllers(const Twin& twin, const std::string& recording) {
  const SpringMassSystem& system = twin.levels[0].system;
  const int nodes = system.node_count();
  std::vector<std::string> warnings;
  for (int c : system.UnjoinedControllers()) {
    const Eigen::Vector3d place = system.position.col(nodes + c);
    const double nearest =
        (system.position.leftCols(nodes).colwise() - place).colwise().norm().minCoeff();
    warnings.push_back(fmt::format(
        "recording {}: controller {} is joined to no particle, the nearest is {:.3g} m away; it "
        "moves nothing",
        recording, c, nearest));
  }
  return warnings;
}

}  // namespace physpring
