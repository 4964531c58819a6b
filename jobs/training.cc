// SPDX-License-Identifier: Apache-2.0
#include "jobs/training.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include "trainer/fits/train.h"
#include "twin/error.h"
#include "twin/predict.h"
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
  Running(const Checkpoint& checkpoint, double interval, const TellProgress& progress,
          Journal* journal, TrainingRun* run)
      : checkpoint_(checkpoint),
        interval_(interval),
        progress_(progress),
        journal_(*journal),
        run_(*run) {
    journal->progress = [this](double share, const std::string& status) { Begin(share, status); };
    journal->kept = [this](const Journal::Piece& piece) { End(piece); };
    journal->reached = [this](const Twin& twin) { so_far_ = twin; };
  }

  void WriteUnfinished() {
    if (whole_) return;  // stopped as it was judged
    const Stopwatch writing;
    run_.twin = checkpoint_.Write(so_far_, journal_);
    Written(writing.seconds());
  }
  // It says how well it fits. Where that cannot be judged it is written all the same.
  void Finish(Twin twin, const TrainingTask& task) {
    try {
      run_.fit = JudgeTraining(task, checkpoint_.Finished(twin));
    } catch (...) {
      WriteFinished(twin);
      throw;
    }
    twin.fit_errors = run_.fit.errors;
    WriteFinished(twin);
    run_.parts.emplace_back("writing checkpoints", checkpoint_seconds_);
  }

 private:
  void WriteFinished(const Twin& twin) {
    const Stopwatch writing;
    run_.twin = checkpoint_.WriteFinished(twin);
    whole_ = true;
    Written(writing.seconds());
  }
  // Before a step.
  void Begin(double share, const std::string& status) {
    StopIfRequested();
    progress_(share, status);
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

  const Checkpoint& checkpoint_;
  double interval_;
  const TellProgress& progress_;
  Journal& journal_;
  TrainingRun& run_;
  Twin so_far_;
  bool whole_ = false;  // the finished twin is written
  Stopwatch since_step_, since_checkpoint_;
  double checkpoint_seconds_ = 0;
};

// Whether a force is known in a frame that is fitted.
bool HasFittedForce(const Recording& recording) {
  const auto end = recording.force.begin() +
                   std::min(recording.train_frames, static_cast<int>(recording.force.size()));
  return std::any_of(recording.force.begin(), end,
                     [](const Eigen::MatrixXd& frame) { return !frame.array().isNaN().all(); });
}

// Of forces that did not set the twin's scale, or set it far from what the recording says.
std::vector<std::string> WarnOfForces(const Twin& twin, const FitData& data) {
  constexpr double kFar = 10;
  const double weighed = twin.levels[0].system.mass.sum();
  std::vector<std::string> warnings;
  for (const Recording& recording : data.recordings) {
    if (recording.force.empty()) continue;
    const auto warn = [&](const std::string& what) {
      warnings.push_back(fmt::format("recording {}: array 'force' {}", recording.name, what));
    };
    const double times = weighed / recording.mass;
    if (twin.force_scale && (times > kFar || times < 1 / kFar)) {
      warn(fmt::format("makes it {:.4g} kg, {:.3g} times its 'mass' of {:.4g} kg; is it in N?",
                       weighed, times, recording.mass));
    }
    if (twin.force_scale) continue;
    warn(HasFittedForce(recording)
             ? "is not used: it does not agree with how the grasps must pull the object (N, in the "
               "axes of the recording)"
             : "is not used: it has no number in a frame for fitting");
  }
  return warnings;
}

// A line for each controller that no spring of the twin joins, naming the recording.
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

}  // namespace

TrainingRun RunTraining(const TrainingTask& task, const Checkpoint& checkpoint, bool resume,
                        double interval, const TellProgress& progress) {
  Journal journal;
  TrainingRun run;
  std::optional<Twin> before;
  if (resume) before = checkpoint.Resume(&journal);
  if (before && IsFinished(*before) && before->fit_errors) {
    run.twin = *before;
    run.fit = JudgeTraining(task, run.twin);
    return run;
  }
  Running running(checkpoint, interval, progress, &journal, &run);
  try {
    const Work work(&journal, checkpoint.Key());
    const bool trained = before && IsFinished(*before);  // and was not yet judged
    running.Finish(trained ? *before : Train(task.data, task.options, task.dense, work), task);
  } catch (const Stopped&) {
    run.stopped = true;
    running.WriteUnfinished();
  }
  return run;
}

void ExpectLevel0Of(const FitData& data, const Twin& twin, const std::string& path) {
  ExpectSameObject(twin, data.recordings[0]);
  for (const Recording& recording : data.recordings) {
    if (twin.TrainingOn(recording.hash)) continue;
    throw Error(fmt::format(
        "{}: was not trained on recording {}; --from needs a twin of the same recordings", path,
        recording.name));
  }
}

std::vector<EffectValues> EffectsOf(const Twin& twin, const std::string& path) {
  if (!twin.levels[0].system.effects.empty()) return twin.levels[0].system.effects;
  throw Error(fmt::format("{}: this twin has no effects", path));
}

FitReport JudgeTraining(const TrainingTask& task, const Twin& twin) {
  FitReport report = JudgeFit(twin, ByClockOf(twin, task.data), task.options);
  std::vector<std::string> warnings = WarnOfForces(twin, task.data);
  for (const auto& more : {WarnOfUnjoinedControllers(twin, task.data.recordings[0].name),
                           std::vector<std::string>(report.warnings)}) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  }
  report.warnings = std::move(warnings);
  return report;
}

}  // namespace physpring
