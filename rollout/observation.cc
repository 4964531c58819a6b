// SPDX-License-Identifier: Apache-2.0
#include "rollout/observation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

namespace physpring {
namespace {

constexpr double kWanderTime = 1;  // s, of a spot from one point to the next

// A spot on the object, on its way from one point to another.
struct Spot {
  Eigen::Index from, to;
};

}  // namespace

void AddNoise(double noise, std::uint64_t seed, std::vector<Points>* frames) {
  if (noise == 0) return;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> error(0, noise);
  for (std::size_t frame = 1; frame < frames->size(); ++frame) {
    for (double& coordinate : (*frames)[frame].reshaped()) coordinate += error(random);
  }
}

void AddOcclusion(double hidden, double fps, std::uint64_t seed, std::vector<Points>* frames) {
  const Eigen::Index count = frames->front().cols();
  const auto hidden_count = std::lround(hidden * static_cast<double>(count));
  if (hidden_count == 0) return;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<Eigen::Index> any_point(0, count - 1);
  std::array<Spot, 2> spots;
  for (Spot& spot : spots) spot = {any_point(random), any_point(random)};

  double way = 0;  // how far spots are from their points to the next, in [0, 1)
  std::vector<std::pair<double, Eigen::Index>> nearness(static_cast<std::size_t>(count));
  for (std::size_t frame = 1; frame < frames->size(); ++frame) {
    way += 1 / (fps * kWanderTime);
    while (way >= 1) {
      for (Spot& spot : spots) spot = {spot.to, any_point(random)};
      way -= 1;
    }
    Points& points = (*frames)[frame];
    for (Eigen::Index i = 0; i < count; ++i) {
      double nearest = std::numeric_limits<double>::infinity();  // squared distance to a spot, m^2
      for (const Spot& spot : spots) {
        const Eigen::Vector3d centre =
            (1 - way) * points.col(spot.from) + way * points.col(spot.to);
        nearest = std::min(nearest, (points.col(i) - centre).squaredNorm());
      }
      nearness[static_cast<std::size_t>(i)] = {nearest, i};
    }
    std::nth_element(nearness.begin(), nearness.begin() + hidden_count - 1, nearness.end());
    for (auto point = nearness.begin(); point != nearness.begin() + hidden_count; ++point) {
      points.col(point->second).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
}

}  // namespace physpring
