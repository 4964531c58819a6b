// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/loss.h"

#include <cmath>
#include <vector>

#include "twin/neighbours.h"

namespace physpring {
namespace {

std::vector<int> SeenColumns(const Points& points) {
  std::vector<int> seen;
  for (int i = 0; i < points.cols(); ++i) {
    if (!std::isnan(points(0, i))) seen.push_back(i);
  }
  return seen;
}

double AddTrackLoss(const Points& position, const Recording& recording, int frame,
                    const LossOptions& options, Points* position_bar) {
  const Points& measured = recording.points[frame];
  const std::vector<int> seen = SeenColumns(measured);
  const double each = options.track_weight / (3.0 * static_cast<double>(seen.size()));
  const double beta = options.track_beta;
  double loss = 0;
  for (int i : seen) {
    const double scale = each * recording.WeightOf(frame, i);
    for (int j = 0; j < 3; ++j) {
      const double r = position(j, i) - measured(j, i);
      const bool inner = std::abs(r) < beta;
      loss += scale * (inner ? r * r / (2 * beta) : std::abs(r) - beta / 2);
      (*position_bar)(j, i) += scale * (inner ? r / beta : std::copysign(1.0, r));
    }
  }
  return loss;
}

// The nearest particle is looked for, but not differentiated.
double AddChamferLoss(const Points& position, const Points& measured, int surface_particles,
                      const LossOptions& options, Points* position_bar) {
  const std::vector<int> seen = SeenColumns(measured);
  const NeighbourSearch search(position.leftCols(surface_particles));
  const double scale = options.chamfer_weight / static_cast<double>(seen.size());
  double loss = 0;
  for (int i : seen) {
    const int nearest = search.Nearest(measured.col(i), 1)[0].index;
    const Eigen::Vector3d r = position.col(nearest) - measured.col(i);
    loss += scale * r.squaredNorm();
    position_bar->col(nearest) += 2 * scale * r;
  }
  return loss;
}

}  // namespace

double AddFrameLoss(const Points& position, const Recording& recording, int frame,
                    const LossOptions& options, Points* position_bar) {
  double loss = 0;
  if (options.track_weight > 0) {
    loss += AddTrackLoss(position, recording, frame, options, position_bar);
  }
  if (options.chamfer_weight > 0) {
    const Points& surface =
        recording.surface.empty() ? recording.points[frame] : recording.surface[frame];
    loss += AddChamferLoss(position, surface, recording.point_count(), options, position_bar);
  }
  return loss;
}

}  // namespace physpring
