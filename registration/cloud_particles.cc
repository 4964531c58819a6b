// SPDX-License-Identifier: Apache-2.0
#include "registration/cloud_particles.h"

#include <limits>
#include <vector>

#include "twin/checks/motion_scale.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr int kRounds = 8;  // of Lloyd's iteration

// Each one is the farthest from those before it. The first one is the farthest from the mean.
Points FarthestPoints(const Points& cloud, int count) {
  constexpr double kDistinct = 1e-6;  // m
  Eigen::Index next = 0;
  (cloud.colwise() - cloud.rowwise().mean()).colwise().squaredNorm().maxCoeff(&next);
  Eigen::RowVectorXd distance =
      Eigen::RowVectorXd::Constant(cloud.cols(), std::numeric_limits<double>::infinity());
  Points chosen(3, count);
  for (int i = 0; i < count; ++i) {
    if (distance[next] < kDistinct * kDistinct) return chosen.leftCols(i);
    chosen.col(i) = cloud.col(next);
    distance = distance.cwiseMin((cloud.colwise() - cloud.col(next)).colwise().squaredNorm());
    distance.maxCoeff(&next);
  }
  return chosen;
}

// Each particle moves to the mean of the points that are nearest to it, if there are any.
Points MoveToMeans(const Points& particles, const Points& cloud) {
  const NeighbourSearch search(particles);
  Points sum = Points::Zero(3, particles.cols());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(particles.cols());
  for (const auto& point : cloud.colwise()) {
    const int nearest = search.Nearest(point, 1)[0].index;
    sum.col(nearest) += point;
    ++count[nearest];
  }
  Points moved = particles;
  for (Eigen::Index i = 0; i < moved.cols(); ++i) {
    if (count[i] > 0) moved.col(i) = sum.col(i) / count[i];
  }
  return moved;
}

}  // namespace

Points PointsOf(const Points& cloud) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    if (cloud.col(i).allFinite()) known.push_back(i);
  }
  return cloud(Eigen::all, known);
}

Points Thinned(const Points& cloud, int most) {
  Points points = PointsOf(cloud);
  if (points.cols() <= most) return points;
  const Eigen::Index step = (points.cols() + most - 1) / most;
  const Eigen::Index count = (points.cols() + step - 1) / step;
  return points(Eigen::all, Eigen::seqN(0, count, step));
}

Points WithoutOutliers(const Points& cloud) {
  constexpr int kNearest = 4;  // itself is one of them
  constexpr double kFar = 6;
  if (cloud.cols() < kNearest) return cloud;
  const NeighbourSearch search(cloud);
  std::vector<double> distance;
  for (const auto& point : cloud.colwise()) {
    distance.push_back(search.Nearest(point, kNearest).back().distance);
  }
  const double usual = Median(distance);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    if (distance[static_cast<std::size_t>(i)] <= kFar * usual) kept.push_back(i);
  }
  return cloud(Eigen::all, kept);
}

Points SpreadParticles(const Points& cloud, int count) {
  Points particles = FarthestPoints(cloud, count);
  if (particles.cols() < count) return particles;
  for (int round = 0; round < kRounds; ++round) particles = MoveToMeans(particles, cloud);
  return particles;
}

}  // namespace physpring
