// SPDX-License-Identifier: Apache-2.0
#include "cli/training.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <vector>

#include "cli/interrupt.h"
#include "cli/progress.h"
#include "trainer/parallel.h"
#include "twin/evaluate.h"

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

// Mean over the recordings that have data, m.
struct TrackMean {
  double sum = 0;
  int count = 0;

  void Add(const MeanError& error) {
    sum += error.value.value_or(0);
    count += error.value.has_value();
  }
  std::string InMillimetres() const {
    return count > 0 ? fmt::format("{:.3f} mm", 1e3 * sum / count) : "no data";
  }
};

// To the last part or, if it is another one, to a new one; a step between two parts has no name.
void AddTime(const std::string& part, double seconds,
             std::vector<std::pair<std::string, double>>* parts) {
  if (part.empty()) return;
  if (parts->empty() || parts->back().first != part) parts->emplace_back(part, 0);
  parts->back().second += seconds;
}

}  // namespace

TrainingRun RunTraining(Fitter* fitter, const Checkpoint& checkpoint, double interval) {
  const InterruptWatch interrupt;
  Progress progress(fitter->Progress());
  TrainingRun run;
  double checkpoint_seconds = 0;
  const auto write = [&] {
    const Stopwatch writing;
    run.twin = checkpoint.Write(*fitter, run.finished);
    checkpoint_seconds += writing.seconds();
    spdlog::info("checkpoint written in {:.2f} s", writing.seconds());
  };
  Stopwatch since_checkpoint;
  while (!run.finished && interrupt.signal() == 0) {
    const Stopwatch step;
    const std::string part = fitter->Part();
    run.finished = !fitter->Step();
    if (run.finished) break;
    AddTime(part, step.seconds(), &run.parts);
    spdlog::info("{:5.1f} %  {}", 100 * fitter->Progress(), fitter->Status());
    progress.Show(fitter->Progress(), fitter->Status());
    if (since_checkpoint.seconds() < interval) continue;
    write();
    since_checkpoint = Stopwatch();
  }
  run.signal = interrupt.signal();
  write();
  run.parts.emplace_back("writing checkpoints", checkpoint_seconds);
  return run;
}

std::string DescribeFitError(const Twin& twin, const FitData& data, bool single_precision,
                             int threads) {
  const int count = static_cast<int>(data.recordings.size());
  std::vector<ErrorMeans> fitted(count), motionless(count);
  ParallelFor(count, threads, [&](int i) {
    const Recording& recording = data.recordings[i];
    const RecordingResult result = Evaluate(twin, recording, {single_precision, 0});
    fitted[i] = MeansOverFrames(result.levels[0].direct, 1, recording.train_frames);
    motionless[i] = MeansOverFrames(result.motionless, 1, recording.train_frames);
  });
  TrackMean fit, still;
  for (int i = 0; i < count; ++i) {
    fit.Add(fitted[i].track);
    still.Add(motionless[i].track);
  }
  return fmt::format("track error on the fit frames: {} (a motionless body: {})",
                     fit.InMillimetres(), still.InMillimetres());
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
