// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/motion_scale.h"

#include <algorithm>
#include <cmath>

#include "twin/neighbours.h"

namespace physpring {
namespace {

// The median of |x| of a normal deviate, and the deviation of a third difference of noise 1.
const double kThirdDifference = 0.6745 * std::sqrt(20.0);
constexpr int kMostNoiseFrames = 400;  // that the noise is estimated from
constexpr std::size_t kMostNoiseValues = 1000000;

double RootMeanSquareMotion(const std::vector<Points>& frames) {
  double sum = 0;
  double count = 0;
  for (Eigen::Index i = 0; i < frames[0].cols(); ++i) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double square = 0, seen = 0;
    for (const Points& frame : frames) {
      if (!frame.col(i).allFinite()) continue;
      const Eigen::Vector3d x =
          frame.col(i) - frames[0].col(i).array().isFinite().select(frames[0].col(i), 0);
      mean += x;
      square += x.squaredNorm();
      ++seen;
    }
    if (seen == 0) continue;
    sum += square - mean.squaredNorm() / seen;
    count += seen;
  }
  return std::sqrt(std::max(0.0, sum) / std::max(1.0, count));
}

}  // namespace

double Quantile(double part, std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double Median(std::vector<double> values) { return Quantile(0.5, std::move(values)); }

double MeasurementNoise(const std::vector<Points>& frames) {
  std::vector<double> differences;
  const std::size_t values = frames.size() * static_cast<std::size_t>(frames[0].size());
  const std::size_t step =
      1 + std::max(frames.size() / kMostNoiseFrames, values / kMostNoiseValues);
  for (std::size_t t = 3; t < frames.size(); t += step) {
    const Points third = frames[t] - 3 * frames[t - 1] + 3 * frames[t - 2] - frames[t - 3];
    for (double x : third.reshaped()) {
      if (std::isfinite(x)) differences.push_back(std::abs(x));
    }
  }
  return Median(std::move(differences)) / kThirdDifference;
}

MotionScale ScaleOf(const Recording& recording) {
  MotionScale scale;
  const Points points = recording.start.leftCols(recording.point_count());
  scale.size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const Points particles = recording.start.leftCols(recording.particle_count());
  if (particles.cols() > 1) scale.spacing = MedianSpacing(particles);
  scale.noise = MeasurementNoise(recording.points);
  scale.motion = RootMeanSquareMotion(recording.points);
  return scale;
}

}  // namespace physpring
