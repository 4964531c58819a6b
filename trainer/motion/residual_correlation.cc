// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/residual_correlation.h"

#include <algorithm>
#include <cmath>

#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

// Sums over points that are seen in two fitted frames, `lag` frames apart.
class Sums {
 public:
  explicit Sums(int lag) : lag_(lag) {}

  void Add(const Episode& episode, const std::vector<Points>& errors) {
    for (int frame = 1 + lag_; frame < episode.frames; ++frame) {
      const Points &now = errors[frame], &before = errors[frame - lag_];
      for (int i = 0; i < std::min(now.cols(), before.cols()); ++i) {
        const double of_point = now.col(i).dot(before.col(i));
        if (std::isnan(of_point)) continue;
        product_ += of_point;
        square_ += 0.5 * (now.col(i).squaredNorm() + before.col(i).squaredNorm());
      }
    }
  }
  double Correlation() const { return square_ > 0 ? product_ / square_ : 1; }

 private:
  int lag_;
  double product_ = 0, square_ = 0;
};

// Of each frame; none in frames that are not fitted.
std::vector<Points> ErrorsOf(const Episode& episode, const std::vector<Points>& particles) {
  const std::vector<Points>& measured = episode.recording->points;
  std::vector<Points> errors(static_cast<std::size_t>(episode.frames), Points(3, 0));
  for (int frame = 1; frame < episode.frames; ++frame) {
    if (episode.UseOf(frame) != FrameUse::kFit) continue;
    errors[frame] = particles[frame].leftCols(measured[frame].cols()) - measured[frame];
  }
  return errors;
}

// At lags of 1 to `most_lag` frames; empty where a motion diverges.
std::vector<double> Correlations(const SpringMassSystem& system,
                                 const std::vector<Episode>& episodes,
                                 const RolloutOptions& options, int most_lag) {
  std::vector<Sums> sums;
  for (int lag = 1; lag <= most_lag; ++lag) sums.emplace_back(lag);
  const bool ended = VisitMotions(
      system, episodes, options, [&](const Episode& episode, const std::vector<Points>& particles) {
        const std::vector<Points> errors = ErrorsOf(episode, particles);
        for (Sums& sum : sums) sum.Add(episode, errors);
      });
  if (!ended) return {};
  std::vector<double> correlations;
  for (const Sums& sum : sums) correlations.push_back(sum.Correlation());
  return correlations;
}

}  // namespace

double ResidualCorrelation(const SpringMassSystem& system, const std::vector<Episode>& episodes,
                           RolloutOptions options) {
  const std::vector<double> correlations = Correlations(system, episodes, options, 1);
  return correlations.empty() ? 1 : correlations[0];
}

double ResidualCorrelationTime(const SpringMassSystem& system, const std::vector<Episode>& episodes,
                               RolloutOptions options) {
  constexpr double kNoise = 0.02;
  int frames = 0;
  for (const Episode& episode : episodes) frames = std::max(frames, episode.frames);
  const std::vector<double> correlations = Correlations(system, episodes, options, frames / 4);
  if (correlations.empty()) return frames;
  double time = 1;
  for (double correlation : correlations) {
    if (correlation < kNoise) break;
    time += 2 * correlation;
  }
  return time;
}

}  // namespace physpring
