// SPDX-License-Identifier: Apache-2.0
// A solid block of which a camera sees one half. Nothing that is seen holds its other side back.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/swung_rope.h"
#include "tracker/track_recording.h"
#include "trainer/bodies/start_system.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr int kFrames = 90, kWide = 7, kDeep = 4;
constexpr double kSpacing = 0.02;  // m

// A soft block that a hand above it moves to and fro. Its inner nodes are interior particles.
Recording Block() {
  std::vector<Eigen::Vector3d> outside, inside;
  for (int i = 0; i < kWide; ++i) {
    for (int j = 0; j < kDeep; ++j) {
      for (int k = 0; k < kDeep; ++k) {
        const bool inner = i % (kWide - 1) && j % (kDeep - 1) && k % (kDeep - 1);
        (inner ? inside : outside).emplace_back(kSpacing * Eigen::Vector3d(i, j, k));
      }
    }
  }
  Recording block;
  block.name = "block";
  block.fps = 30;
  block.mass = 0.2;
  block.train_frames = kFrames;
  const auto points = static_cast<int>(outside.size()), inner = static_cast<int>(inside.size());
  block.start.resize(3, points + inner + 2);
  for (int i = 0; i < points; ++i) block.start.col(i) = outside[i];
  for (int i = 0; i < inner; ++i) block.start.col(points + i) = inside[i];
  const double middle = kSpacing * (kDeep - 1) / 2, above = kSpacing * kDeep;
  block.start.rightCols(2) << kSpacing, kSpacing * (kWide - 2), middle, middle, above, above;
  block.interior = block.start.middleCols(points, inner);
  block.velocity = Points::Zero(3, points + inner);
  block.rest = block.start;
  for (int t = 0; t < kFrames; ++t) {
    block.points.emplace_back(block.start.leftCols(points));
    block.controllers.emplace_back(block.start.rightCols(2));
    block.controllers[t].row(0).array() += 0.03 * std::sin(6 * t / block.fps);
    block.controllers[t].row(1).array() += 0.03 * std::sin(4 * t / block.fps);
  }
  return block;
}

TEST(OneSidedClouds, DoNotPullASolidToTheirSide) {
  Recording block = Block();
  const SpringMassSystem system = MakeStartSystem(block, {});
  MoveAs(system, true, &block);
  std::vector<int> seen;
  for (int i = 0; i < block.point_count(); ++i) {
    if (block.start(1, i) > kSpacing * (kDeep - 1) / 2) seen.push_back(i);
  }
  std::mt19937_64 generator(4);
  for (const Points& frame : block.points) {
    Points cloud = frame(Eigen::all, seen);
    for (double& x : cloud.reshaped()) x += 1e-3 * Normal(&generator);
    block.surface.push_back(cloud);
  }
  Twin twin;
  twin.levels.push_back({system, {}, 1});
  twin.points = block.point_count();
  twin.interior = block.interior_count();
  twin.fps = block.fps;
  const TrackedMotion motion = TrackRecording(twin, block, {.cloud = true});
  EXPECT_LT(motion.errors.tracked, 0.05 * kSpacing);
}

}  // namespace
}  // namespace physpring
