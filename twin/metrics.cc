// SPDX-License-Identifier: Apache-2.0
#include "twin/metrics.h"

#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>

#include "twin/neighbours.h"
#include "twin/point_cloud.h"

namespace physpring {
namespace {

constexpr double kNoData = std::numeric_limits<double>::quiet_NaN();

bool IsSeen(const Points& points, Eigen::Index i) { return !std::isnan(points(0, i)); }

// Mean over the seen columns of `measured` of length(least Metric to a column of `predicted`).
template <class Metric, class Length>
double MeanNearest(const Points& measured, const Points& predicted, Length length) {
  const PointCloud cloud{predicted};
  nanoflann::KDTreeSingleIndexAdaptor<Metric, PointCloud, 3, int> tree(3, cloud);
  tree.buildIndex();
  double sum = 0;
  int seen = 0;
  for (Eigen::Index i = 0; i < measured.cols(); ++i) {
    if (!IsSeen(measured, i)) continue;
    int nearest = 0;
    double least = 0;
    tree.knnSearch(measured.col(i).data(), 1, &nearest, &least);
    sum += length(least);
    ++seen;
  }
  return seen > 0 ? sum / seen : kNoData;
}

const std::vector<Points>& SurfaceOf(const Recording& recording) {
  return recording.surface.empty() ? recording.points : recording.surface;
}

const std::vector<Points>& TrackOf(const Recording& recording) {
  return recording.track.empty() ? recording.points : recording.track;
}

}  // namespace

double ChamferDistance(const Points& measured, const Points& predicted, Norm norm) {
  if (norm == Norm::kL1) {
    return MeanNearest<nanoflann::L1_Adaptor<double, PointCloud>>(measured, predicted,
                                                                  [](double l1) { return l1; });
  }
  return MeanNearest<nanoflann::L2_Simple_Adaptor<double, PointCloud>>(
      measured, predicted, [](double squared) { return std::sqrt(squared); });
}

double TrackError(const Points& measured, const Points& predicted, const std::vector<int>& nodes) {
  double sum = 0;
  int seen = 0;
  for (Eigen::Index i = 0; i < measured.cols(); ++i) {
    const int node = nodes[static_cast<std::size_t>(i)];
    if (node < 0 || !IsSeen(measured, i)) continue;
    sum += (predicted.col(node) - measured.col(i)).norm();
    ++seen;
  }
  return seen > 0 ? sum / seen : kNoData;
}

std::vector<int> NearestNodesAtStart(const Recording& recording, const Points& nodes) {
  const NeighbourSearch search(nodes);
  const Points at_start = recording.track.empty()
                              ? Points(recording.start.leftCols(recording.point_count()))
                              : recording.track[0];
  std::vector<int> nearest;
  for (Eigen::Index i = 0; i < at_start.cols(); ++i) {
    nearest.push_back(IsSeen(at_start, i) ? search.Nearest(at_start.col(i), 1)[0].index : -1);
  }
  return nearest;
}

std::vector<int> ParticlesOfTrack(const Recording& recording) {
  if (!recording.track.empty()) {
    return NearestNodesAtStart(recording, recording.start.leftCols(recording.particle_count()));
  }
  std::vector<int> particles(recording.point_count());
  std::iota(particles.begin(), particles.end(), 0);
  return particles;
}

FrameErrors ComputeFrameErrors(const Recording& recording, const std::vector<Points>& predicted,
                               const std::vector<int>& surface, const std::vector<int>& track) {
  FrameErrors errors;
  for (std::size_t frame = 0; frame < recording.points.size(); ++frame) {
    const Points& measured = SurfaceOf(recording)[frame];
    const Points surface_nodes = predicted[frame](Eigen::all, surface);
    errors.cd.push_back(ChamferDistance(measured, surface_nodes, Norm::kL1));
    errors.cd_euclidean.push_back(ChamferDistance(measured, surface_nodes, Norm::kEuclidean));
    errors.track.push_back(TrackError(TrackOf(recording)[frame], predicted[frame], track));
  }
  return errors;
}

FrameErrors ComputeParticleErrors(const Recording& recording,
                                  const std::vector<Points>& particles) {
  std::vector<int> surface(recording.point_count());
  std::iota(surface.begin(), surface.end(), 0);
  return ComputeFrameErrors(recording, particles, surface, ParticlesOfTrack(recording));
}

MeanError MeanOverFrames(const std::vector<double>& errors, int first, int last) {
  MeanError mean;
  double sum = 0;
  for (int frame = first; frame < last; ++frame) {
    if (std::isnan(errors[frame])) {
      ++mean.frames_without_data;
    } else {
      sum += errors[frame];
      ++mean.frames;
    }
  }
  if (mean.frames > 0) mean.value = sum / mean.frames;
  return mean;
}

std::optional<double> PublishedL1(const Recording& recording,
                                  const std::vector<Points>& predicted) {
  std::vector<double> errors;
  for (std::size_t frame = 0; frame < recording.points.size(); ++frame) {
    const Points& measured = recording.points[frame];
    double sum = 0;
    int seen = 0;
    for (Eigen::Index i = 0; i < measured.cols(); ++i) {
      if (!IsSeen(measured, i)) continue;
      sum += (predicted[frame].col(i) - measured.col(i)).lpNorm<1>();
      ++seen;
    }
    const int coordinates = 3 * (seen + recording.controller_count());
    errors.push_back(seen > 0 ? sum / coordinates : kNoData);
  }
  const int frames = recording.frame_count();
  const MeanError mean = MeanOverFrames(errors, 1, frames);
  if (!mean.value) return std::nullopt;
  return *mean.value * (frames - 1) / (frames + 1);
}

}  // namespace physpring
