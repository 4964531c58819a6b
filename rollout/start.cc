// SPDX-License-Identifier: Apache-2.0
#include "rollout/start.h"

#include <cmath>
#include <numbers>
#include <random>

#include "twin/uniform.h"

namespace physpring {

EpisodeStart StartOf(const Task& task, std::uint64_t seed, int episode,
                     const Disturbance& disturbance) {
  const auto word = [](std::uint64_t bits) { return static_cast<std::uint32_t>(bits); };
  std::seed_seq mix{word(seed), word(seed >> 32), word(static_cast<std::uint64_t>(episode))};
  std::mt19937_64 random(mix);

  const StartOptions& starts = task.starts;
  const auto around = [&](double noise) { return noise * (2 * Uniform(&random) - 1); };
  std::size_t cell = static_cast<std::size_t>(episode % starts.cells());
  const double yaw = starts.yaw[cell % starts.yaw.size()] + around(starts.noise_yaw);
  cell /= starts.yaw.size();
  const double y = starts.y[cell % starts.y.size()] + around(starts.noise_xy);
  cell /= starts.y.size();
  const double x = starts.x[cell] + around(starts.noise_xy);

  EpisodeStart start;
  start.episode = episode;
  start.object.position = task.object.position + Eigen::Vector3d(x, y, 0);
  start.object.orientation = (Yaw(yaw) * task.object.orientation).normalized();
  Eigen::Vector3d normal;
  for (double& coordinate : normal) coordinate = Normal(&random);
  if (disturbance.action > 0) {
    start.action_offset.head<2>() = disturbance.action * normal.head<2>();
  }
  start.seed = random();
  const double direction = 2 * std::numbers::pi * Uniform(&random);
  start.object.position +=
      disturbance.start * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0);
  return start;
}

}  // namespace physpring
