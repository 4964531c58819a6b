// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/residual_pattern.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "twin/effects/body_coordinate.h"

namespace physpring {
namespace {

constexpr int kBins = 10;

struct Sample {
  double x, y;
};

BinnedMeans Bin(std::vector<Sample> samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& p, const Sample& q) { return p.x < q.x; });
  BinnedMeans means;
  const std::size_t count = samples.size();
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const std::size_t first = bin * count / kBins, last = (bin + 1) * count / kBins;
    if (last <= first) continue;
    double x = 0, y = 0, squared = 0;
    for (std::size_t i = first; i < last; ++i) {
      x += samples[i].x, y += samples[i].y, squared += samples[i].y * samples[i].y;
    }
    const double n = static_cast<double>(last - first), mean = y / n;
    means.x.push_back(x / n);
    means.y.push_back(mean);
    means.error.push_back(std::sqrt(std::max(0.0, squared / n - mean * mean) / n));
  }
  return means;
}

// For each node, the sum over its springs of the strain, towards the other end. Springs to
// controllers are left out.
Points Stretch(const SpringMassSystem& system, const Points& position) {
  Points stretch = Points::Zero(3, position.cols());
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto& [a, b] = system.springs[static_cast<std::size_t>(e)];
    if (a >= position.cols() || b >= position.cols()) continue;
    const Eigen::Vector3d way = position.col(b) - position.col(a);
    const double length = way.norm(), rest = system.rest_length[e];
    if (length <= 0 || rest <= 0) continue;
    const Eigen::Vector3d pull = (length / rest - 1) / length * way;
    stretch.col(a) += pull;
    stretch.col(b) -= pull;
  }
  return stretch;
}

// Force along `direction` against its length, and the sums that a cosine needs.
class Comparison {
 public:
  void Add(const Eigen::Vector3d& force, const Eigen::Vector3d& direction) {
    const double length = direction.norm();
    if (length <= 0) return;
    samples_.push_back({length, force.dot(direction) / length});
    product_ += force.dot(direction);
    force_squared_ += force.squaredNorm();
    direction_squared_ += direction.squaredNorm();
  }
  BinnedMeans Means() const { return Bin(samples_); }
  double Cosine() const {
    const double norms = std::sqrt(force_squared_ * direction_squared_);
    return norms > 0 ? product_ / norms : 0;
  }

 private:
  std::vector<Sample> samples_;
  double product_ = 0, force_squared_ = 0, direction_squared_ = 0;
};

// Amplitudes of the three coordinates together at k / duration, k = 1, 2, ... up to half the rate.
std::vector<double> Spectrum(const Points& series) {
  const auto count = static_cast<int>(series.cols());
  std::vector<double> spectrum;
  for (int k = 1; 2 * k <= count; ++k) {
    Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
    for (int t = 0; t < count; ++t) {
      sum += std::polar(1.0, -2 * std::numbers::pi * k * t / count) * series.col(t);
    }
    spectrum.push_back(2 / static_cast<double>(count) * sum.norm());
  }
  return spectrum;
}

}  // namespace

ResidualPattern PatternOf(const ResidualForce& residual, const SpringMassSystem& system,
                          double fps) {
  ResidualPattern pattern;
  const auto nodes = static_cast<Eigen::Index>(system.node_count());
  const auto steps = static_cast<Eigen::Index>(residual.force.size());
  pattern.left = residual.left;
  pattern.converged = residual.converged;
  pattern.noise = std::sqrt(3 * residual.noise.squaredNorm() / static_cast<double>(nodes));
  pattern.node = system.position.leftCols(nodes);
  pattern.mean_force = Points::Zero(3, nodes);
  pattern.node_force = Eigen::VectorXd::Zero(nodes);
  if (steps == 0) return pattern;

  pattern.net.resize(3, steps);
  Eigen::VectorXd squared = Eigen::VectorXd::Zero(nodes);
  Comparison velocities, stretches;
  for (Eigen::Index t = 0; t < steps; ++t) {
    const Points& force = residual.force[static_cast<std::size_t>(t)];
    const Points &from = residual.position[static_cast<std::size_t>(t)],
                 &to = residual.position[static_cast<std::size_t>(t) + 1];
    const Points stretch = Stretch(system, (from + to) / 2);
    for (Eigen::Index i = 0; i < nodes; ++i) {
      velocities.Add(force.col(i), fps * (to.col(i) - from.col(i)));
      stretches.Add(force.col(i), stretch.col(i));
    }
    pattern.mean_force += force / static_cast<double>(steps);
    squared += force.colwise().squaredNorm().transpose() / static_cast<double>(steps);
    pattern.over_time.push_back(force.norm() / std::sqrt(static_cast<double>(nodes)));
    pattern.net.col(t) = force.rowwise().sum();
  }
  pattern.root_mean_square = std::sqrt(squared.mean());
  pattern.node_force = squared.cwiseSqrt();
  pattern.against_speed = velocities.Means();
  pattern.with_velocity = velocities.Cosine();
  pattern.against_stretch = stretches.Means();
  pattern.with_stretch = stretches.Cosine();

  const Eigen::VectorXd along = BodyCoordinate(system);
  std::vector<Sample> places;
  for (Eigen::Index i = 0; i < nodes; ++i) places.push_back({along[i], pattern.node_force[i]});
  pattern.along_body = Bin(places);
  pattern.spectrum = Spectrum(pattern.net);
  pattern.frequency_step = fps / static_cast<double>(steps);

  // forces m a come nearest to `force`, by force^2 / mass, if a is the mean of all forces over M
  const auto mass = system.mass.head(nodes);
  pattern.acceleration = pattern.net.rowwise().mean() / mass.sum();
  double all = 0;
  for (const Points& force : residual.force) {
    all += (force.colwise().squaredNorm().transpose().array() / mass.array()).sum();
  }
  const double part = static_cast<double>(steps) * mass.sum() * pattern.acceleration.squaredNorm();
  pattern.constant = all > 0 ? part / all : 0;
  return pattern;
}

}  // namespace physpring
