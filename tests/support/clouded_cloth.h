// SPDX-License-Identifier: Apache-2.0
// A swung cloth, of which each frame shows other points.
#ifndef PHYSPRING_TESTS_SUPPORT_CLOUDED_CLOTH_H_
#define PHYSPRING_TESTS_SUPPORT_CLOUDED_CLOTH_H_

#include <cmath>
#include <random>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "twin/stability.h"
#include "twin/uniform.h"

namespace physpring {

inline constexpr int kRows = 9, kFrames = 80;
inline constexpr double kSpacing = 0.02, kNoise = 1e-3;  // m

// A cloth of kRows x kRows points, held at two corners, which swing; at another place if `turned`.
inline Recording SwungCloth(bool turned) {
  Recording recording;
  recording.name = turned ? "turned" : "cloth";
  recording.fps = 50;
  recording.train_frames = kFrames;
  Points cloth(3, kRows * kRows), hands(3, 2);
  for (int i = 0; i < cloth.cols(); ++i) {
    const int row = i / kRows;
    cloth.col(i) = kSpacing * Eigen::Vector3d(i % kRows, 0.1 * (i % 2), -row);
  }
  hands << cloth.col(0), cloth.col(kRows - 1);
  hands.row(2).array() += 0.5 * kSpacing;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(turned ? 0.8 : 0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d shift(0.3 * turned, 0, 0);
  cloth = (turn * cloth).colwise() + shift;
  hands = (turn * hands).colwise() + shift;
  for (int t = 0; t < kFrames; ++t) {
    const Eigen::Vector3d swing(0, 0.06 * std::sin(0.1 * t), 0.02 * std::sin(0.17 * t));
    recording.controllers.emplace_back(hands.colwise() + turn * swing);
  }
  recording.points.assign(kFrames, cloth);
  recording.start.resize(3, cloth.cols() + 2);
  recording.start << cloth, hands;
  recording.rest = recording.start;
  recording.velocity = Points::Zero(3, cloth.cols());
  SpringMassSystem system = MakeStartSystem(recording, {});
  ScaleToSubsteps(1 / recording.fps, 60, kStepSafety, &system);
  MoveAs(system, true, &recording);
  return recording;
}

// Each frame shows points of its own, anywhere on the cloth, with noise.
inline Recording CloudsOf(const Recording& truth, int seed) {
  constexpr int kSeen = 200;
  Recording clouds = truth;
  clouds.points.assign(kFrames, Points(3, 0));
  clouds.start = truth.controllers[0];
  clouds.rest = clouds.start;
  clouds.velocity.resize(3, 0);
  std::mt19937_64 generator(seed);
  for (const Points& cloth : truth.points) {
    Points cloud(3, kSeen);
    for (auto point : cloud.colwise()) {
      const double u = (kRows - 1) * Uniform(&generator), v = (kRows - 1) * Uniform(&generator);
      const int column = static_cast<int>(u), row = static_cast<int>(v);
      const double a = u - column, b = v - row;
      const int i = row * kRows + column;
      point = (1 - a) * (1 - b) * cloth.col(i) + a * (1 - b) * cloth.col(i + 1) +
              (1 - a) * b * cloth.col(i + kRows) + a * b * cloth.col(i + kRows + 1);
      for (double& x : point) x += kNoise * Normal(&generator);
    }
    clouds.surface.push_back(cloud);
  }
  return clouds;
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_CLOUDED_CLOTH_H_
