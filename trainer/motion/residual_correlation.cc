// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/residual_correlation.h"

#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

// Sums over points that are seen in two fitted frames in a row.
struct Sums {
  double product = 0, square = 0;

  void Add(const Episode& episode, const std::vector<Points>& particles);
};

void Sums::Add(const Episode& episode, const std::vector<Points>& particles) {
  const std::vector<Points>& measured = episode.recording->points;
  Points before;  // the errors of the frame before; none: it is not fitted
  for (int frame = 1; frame < episode.frames; ++frame) {
    if (episode.UseOf(frame) != FrameUse::kFit) {
      before.resize(3, 0);
      continue;
    }
    Points error = particles[frame].leftCols(measured[frame].cols()) - measured[frame];
    if (const auto& weight = episode.recording->weight; !weight.empty()) {
      error *= weight[static_cast<std::size_t>(frame)].row(0).cwiseSqrt().asDiagonal();
    }
    for (int i = 0; i < before.cols(); ++i) {
      const double of_point = error.col(i).dot(before.col(i));
      if (std::isnan(of_point)) continue;
      product += of_point;
      square += 0.5 * (error.col(i).squaredNorm() + before.col(i).squaredNorm());
    }
    before = error;
  }
}

}  // namespace

double ResidualCorrelation(const SpringMassSystem& system, const std::vector<Episode>& episodes,
                           RolloutOptions options) {
  Sums sums;
  const bool ended = VisitMotions(
      system, episodes, options, [&](const Episode& episode, const std::vector<Points>& particles) {
        sums.Add(episode, particles);
      });
  if (!ended) return 1;
  return sums.square > 0 ? sums.product / sums.square : 1;
}

}  // namespace physpring
