// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/track_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "twin/metrics.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kLeastError = 1e-9;  // m

// The mean distance in a frame, each by its weight; NaN where nothing was seen.
double WeightedError(const Recording& recording, int frame, const Points& particles) {
  const Points& measured = recording.points[static_cast<std::size_t>(frame)];
  double sum = 0, weights = 0;
  for (Eigen::Index i = 0; i < measured.cols(); ++i) {
    if (std::isnan(measured(0, i))) continue;
    const double weight = recording.WeightOf(frame, i);
    sum += weight * (particles.col(i) - measured.col(i)).norm();
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

FrameTrack TrackOf(const Episode& episode, FrameUse use, const std::vector<Points>& particles) {
  const std::vector<Points>& measured = episode.recording->points;
  std::vector<int> nodes(static_cast<std::size_t>(measured[0].cols()));
  std::iota(nodes.begin(), nodes.end(), 0);
  FrameTrack track;
  for (int frame = 1; frame < episode.frames; ++frame) {
    if (episode.UseOf(frame) != use) continue;
    const double error = episode.recording->weight.empty()
                             ? TrackError(measured[frame], particles[frame], nodes)
                             : WeightedError(*episode.recording, frame, particles[frame]);
    if (!std::isnan(error)) track.push_back(error);
  }
  return track;
}

double Mean(const FrameTrack& track) {
  double sum = 0;
  for (double error : track) sum += error;
  return track.empty() ? std::numeric_limits<double>::quiet_NaN()
                       : sum / static_cast<double>(track.size());
}

double MeanTrackError(const Episode& episode, FrameUse use, const std::vector<Points>& particles) {
  const FrameTrack track = TrackOf(episode, use, particles);
  return track.empty() ? 0 : Mean(track);
}

bool VisitMotions(
    const SpringMassSystem& system, const std::vector<Episode>& episodes, RolloutOptions options,
    const std::function<void(const Episode&, const std::vector<Points>& particles)>& visit) {
  const int given = options.substeps;
  SpringMassSystem cut_system = system;
  double cut_fps = 0;
  for (const Episode& episode : episodes) {
    if (const double fps = episode.recording->fps; fps != cut_fps) {
      const FrameCut cut = CutFrames(1 / fps, given, system);
      options.substeps = cut.substeps;
      cut_system.dashpot_stages = cut.dashpot_stages;
      cut_fps = fps;
    }
    const auto rollout = RollOut(cut_system, episode, options);
    if (rollout->diverged()) return false;
    visit(episode, rollout->positions());
  }
  return true;
}

double GeometricTrackError(const SpringMassSystem& system, const std::vector<Episode>& episodes,
                           FrameUse use, RolloutOptions options) {
  double sum = 0;  // the sum of the errors' logarithms
  const bool ended = VisitMotions(
      system, episodes, options, [&](const Episode& episode, const std::vector<Points>& particles) {
        sum += std::log(std::max(MeanTrackError(episode, use, particles), kLeastError));
      });
  if (!ended) return std::numeric_limits<double>::infinity();
  return std::exp(sum / static_cast<double>(episodes.size()));
}

}  // namespace physpring
