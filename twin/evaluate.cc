// SPDX-License-Identifier: Apache-2.0
#include "twin/evaluate.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "twin/hierarchy.h"
#include "twin/lift.h"

namespace physpring {
namespace {

LevelResult EvaluateLevel(const Twin& twin, int level, const Recording& recording,
                          const PredictOptions& options) {
  LevelResult result;
  const TwinLevel& twin_level = twin.levels[level];
  result.level = level;
  result.nodes = twin_level.system.node_count();
  result.springs = twin_level.system.spring_count();
  result.substeps = ChooseSubsteps(twin_level, recording.fps, options.substeps);

  const auto begin = std::chrono::steady_clock::now();
  result.positions = Predict(twin, level, recording, {options.single_precision, result.substeps});
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  result.frames_per_second = (recording.frame_count() - 1) / std::max(seconds.count(), 1e-9);

  const Lift lift(twin, level, recording.start.leftCols(recording.particle_count()));
  std::vector<Points> particles;
  for (const Points& nodes : result.positions) particles.push_back(lift.Apply(nodes));
  for (const Points& frame : particles) {
    result.points.emplace_back(frame.leftCols(recording.point_count()));
  }
  result.lifted = ComputeParticleErrors(recording, particles);
  result.direct = level == 0
                      ? result.lifted
                      : ComputeFrameErrors(recording, result.positions, SurfaceNodes(twin, level),
                                           NearestNodesAtStart(recording, result.positions[0]));
  result.published_l1 = PublishedL1(recording, result.points);
  return result;
}

}  // namespace

RecordingResult Evaluate(const Twin& twin, const Recording& recording,
                         const PredictOptions& options, const std::vector<Baseline>& others) {
  ExpectSameObject(twin, recording);
  RecordingResult result;
  if (const TrainedOn* trained = twin.TrainingOn(recording.hash)) {
    result.trained_on = true;
    result.first_predicted = std::clamp(trained->train_frames, 1, recording.frame_count());
  }
  for (int level = 0; level < static_cast<int>(twin.levels.size()); ++level) {
    result.levels.push_back(EvaluateLevel(twin, level, recording, options));
  }
  std::vector<Baseline> baselines = PredictBaselines(recording, twin.linear);
  baselines.insert(baselines.end(), others.begin(), others.end());
  for (Baseline& baseline : baselines) {
    result.baselines.push_back(
        {baseline.name, baseline.description, ComputeParticleErrors(recording, baseline.particles),
         PublishedL1(recording, baseline.particles), std::move(baseline.particles)});
  }
  return result;
}

ErrorMeans MeansOverFrames(const FrameErrors& errors, int first, int last) {
  return {MeanOverFrames(errors.cd, first, last), MeanOverFrames(errors.cd_euclidean, first, last),
          MeanOverFrames(errors.track, first, last)};
}

}  // namespace physpring
