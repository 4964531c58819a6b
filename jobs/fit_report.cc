// SPDX-License-Identifier: Apache-2.0
#include "jobs/fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "trainer/bodies/factors.h"
#include "trainer/data/held_back.h"
#include "trainer/fits/net_fit.h"
#include "trainer/motion/residual_correlation.h"
#include "twin/checks/motion_scale.h"
#include "twin/checks/plausibility.h"
#include "twin/dashpot_stages.h"
#include "twin/parallel.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kNearer = 0.95;    // a tie is no warning
constexpr int kMostRecordings = 4;  // tell whether noise is left

// The mean over recordings of their mean track errors in frames [first, last), m; none without
// data.
template <class ErrorsOfRecording>
std::optional<double> MeanTrack(const std::vector<RecordingResult>& results,
                                const std::vector<int>& first, const std::vector<int>& last,
                                ErrorsOfRecording&& errors) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const MeanError mean = MeanOverFrames(errors(results[i]).track, first[i], last[i]);
    sum += mean.value.value_or(0);
    count += mean.value.has_value();
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

std::optional<double> TrackOfLevel0(const std::vector<RecordingResult>& results,
                                    const std::vector<int>& first, const std::vector<int>& last) {
  return MeanTrack(results, first, last,
                   [](const RecordingResult& one) { return one.levels[0].lifted; });
}

std::optional<double> MotionlessTrack(const std::vector<RecordingResult>& results,
                                      const std::vector<int>& first, const std::vector<int>& last) {
  return MeanTrack(results, first, last,
                   [](const RecordingResult& one) { return one.baselines[0].errors; });
}

// Of level 0 in the fit frames.
double CorrelationOf(const Twin& twin, const FitData& data, const TrainOptions& options) {
  RolloutOptions rollout;
  rollout.single_precision = options.single_precision;
  rollout.controller_velocity = twin.controller_velocity;
  return ResidualCorrelation(twin.levels[0].system, FitEpisodes(data, kMostRecordings), rollout);
}

// Whether what level 0 leaves of the fit frames is noise.
std::string WhatIsLeft(const Twin& twin, const FitErrors& errors, const FitData& data,
                       const TrainOptions& options) {
  const bool noise = errors.LeavesNoise();
  std::string line =
      fmt::format("what is left is {} (the errors of one frame and the next correlate by {:.2f})",
                  noise ? "noise" : "more than noise", errors.correlation);
  const bool is_net = twin.material.has_value();  // no chain
  if (noise || !is_net) return line;
  line +=
      "; the body below is not quite the object, whose true values may be far outside the "
      "intervals";
  if (LeavesOutSingleValues(data, options)) {
    line +=
        "; for so many particles and frames single springs were not tried: --optimizer "
        "gauss-newton fits them";
  }
  return line;
}

// One more line if level 0 is as stiff as its fit could make it; else empty.
std::string AtTheStiffest(const Twin& twin, const FitData& data, const TrainOptions& options) {
  constexpr double kNear = 1.01;  // a fit stays a little below
  const double rate = MostRate(options, data.recordings[0]);
  const double stable =
      ComputeStabilityBound(twin.levels[0].system).CheapestTimestep(kMostDashpotStages);
  if (options.method == TrainOptions::Method::kTwoStage || stable > kNear / (rate * kStepSafety)) {
    return "";
  }
  return fmt::format(
      "\nlevel 0 is as stiff as {:g} sub-steps a second allow: the object may be stiffer, and then "
      "its material is not the one below (--substeps N allows more, N in a frame)",
      rate);
}

}  // namespace

std::vector<std::string> NearerBaselines(const std::vector<RecordingResult>& results,
                                         const std::vector<int>& first,
                                         const std::vector<int>& last, const std::string& frames) {
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < results.at(0).baselines.size(); ++b) {
    const auto baseline = MeanTrack(
        results, first, last, [b](const RecordingResult& one) { return one.baselines[b].errors; });
    for (std::size_t l = 0; l < results[0].levels.size(); ++l) {
      const auto level = MeanTrack(
          results, first, last, [l](const RecordingResult& one) { return one.levels[l].lifted; });
      if (!baseline || !level || *baseline >= kNearer * *level) continue;
      lines.push_back(fmt::format("{} predicts {} better than level {}: {:.2f} against {:.2f} mm",
                                  results[0].baselines[b].description, frames, l, 1e3 * *baseline,
                                  1e3 * *level));
    }
  }
  return lines;
}

std::string LittleExplained(const std::vector<RecordingResult>& results,
                            const std::vector<int>& first, const std::vector<int>& last,
                            const Recording& noisy) {
  const auto level = TrackOfLevel0(results, first, last);
  const auto still = MotionlessTrack(results, first, last);
  if (!level || !still) return "";
  return TooLittleExplained(*level, *still, MeasurementNoise(noisy.points));
}

FitReport JudgeFit(const Twin& twin, const FitData& data, const TrainOptions& options) {
  const int count = static_cast<int>(data.recordings.size());
  std::vector<RecordingResult> results(count);
  std::vector<int> first(count, 1), split(count), end(count);
  Twin dense = twin;
  dense.levels.resize(1);
  ParallelFor(count, options.threads, [&](int i) {
    results[i] = Evaluate(dense, data.recordings[i], {options.single_precision, 0});
    split[i] = data.recordings[i].train_frames;
    end[i] = data.recordings[i].frame_count();
  });
  const auto fit = TrackOfLevel0(results, first, split);
  const auto still = MotionlessTrack(results, first, split);
  const auto later = TrackOfLevel0(results, split, end);

  FitReport report;
  if (!fit || !still) {
    report.line = "track error on the fit frames: no data";
    return report;
  }
  report.errors = FitErrors{*fit, *still, later, MeasurementNoise(data.recordings[0].points),
                            CorrelationOf(twin, data, options)};
  report.line = "track error " + DescribeFitErrors(*report.errors) + "\n" +
                WhatIsLeft(twin, *report.errors, data, options) +
                AtTheStiffest(twin, data, options);
  const std::string little = TooLittleExplained(*fit, *still, report.errors->noise);
  if (!little.empty()) report.warnings.push_back(little);
  if (later && report.warnings.empty()) {
    report.warnings = NearerBaselines(results, split, end, "the frames after those for fitting");
  }
  return report;
}

}  // namespace physpring
