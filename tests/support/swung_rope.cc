// SPDX-License-Identifier: Apache-2.0
#include "tests/support/swung_rope.h"

#include <cmath>
#include <random>

#include "twin/predict.h"
#include "twin/twin.h"

namespace physpring {

Recording SwungRope(int particles, int frames) {
  Recording recording;
  recording.name = "rope";
  recording.fps = 50;
  recording.mass = 0.002 * particles;
  recording.interior.resize(3, 0);
  recording.velocity = Points::Zero(3, particles);
  recording.train_frames = frames;
  recording.start.resize(3, particles + 1);
  for (int i = 0; i < particles; ++i) {
    // not quite straight, so that no direction is without stiffness
    recording.start.col(i) = Eigen::Vector3d(0.002 * (i % 3), 0.002 * (i % 2), -0.01 * i);
  }
  recording.start.col(particles) = Eigen::Vector3d(0.001, 0, 0.01);
  recording.rest = recording.start;
  for (int t = 0; t < frames; ++t) {
    recording.points.emplace_back(recording.start.leftCols(particles));
    recording.controllers.emplace_back(recording.start.rightCols(1));
    recording.controllers[t](0, 0) += 0.02 * std::sin(12 * t / recording.fps);
  }
  return recording;
}

void MoveAs(const SpringMassSystem& system, bool controller_velocity, Recording* recording) {
  Twin twin;
  twin.levels.push_back({system, {}, 1});
  twin.points = recording->point_count();
  twin.interior = recording->interior_count();
  twin.controller_velocity = controller_velocity;
  twin.fps = recording->fps;
  const std::vector<Points> motion = Predict(twin, 0, *recording, {});
  for (std::size_t t = 0; t < motion.size(); ++t) {
    recording->points[t] = motion[t].leftCols(recording->point_count());
  }
}

void AddNoise(Recording* recording, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 5e-4);
  for (int t = 1; t < recording->frame_count(); ++t) {
    for (double& value : recording->points[t].reshaped()) value += noise(random);
  }
}

}  // namespace physpring
