// SPDX-License-Identifier: Apache-2.0
#include "twin/resampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace physpring {
namespace {

constexpr double kFps = 50;

// A smooth path of two points.
Points PathAt(double t) {
  Points place(3, 2);
  place << std::sin(4 * t), std::cos(3 * t), t * t, 0.2, -t, std::sin(t);
  return place;
}

std::vector<Points> PathAt(const std::vector<double>& times) {
  std::vector<Points> path;
  for (double t : times) path.push_back(PathAt(t));
  return path;
}

std::vector<double> Times(int frames) {
  std::vector<double> times;
  for (int t = 0; t < frames; ++t) times.push_back(5 + t / kFps);
  return times;
}

TEST(FrameGrid, IsTheFramesThemselvesWhereNoneIsMissing) {
  const FrameGrid grid = GridOf(Times(30), 0);
  EXPECT_EQ(grid.frames, 30);
  EXPECT_NEAR(grid.fps, kFps, 1e-9);
  EXPECT_EQ(grid.start, 5);
  EXPECT_NEAR(OffGrid(Times(30), grid), 0, 1e-12);
}

TEST(FrameGrid, CountsFramesThatAreMissing) {
  std::vector<double> times = Times(30);
  times.erase(times.begin() + 20, times.begin() + 23);
  times.erase(times.begin() + 7);
  const FrameGrid grid = GridOf(times, 0);
  EXPECT_EQ(grid.frames, 30);
  EXPECT_NEAR(grid.fps, kFps, 1e-9);
}

TEST(FrameGrid, TakesTheRateThatIsGiven) {
  const FrameGrid grid = GridOf(Times(31), 100);
  EXPECT_EQ(grid.fps, 100);
  EXPECT_EQ(grid.frames, 61);
}

TEST(Resampling, TakesWhatWasMeasuredAtTheTimeOfAFrame) {
  const std::vector<double> times = Times(30);
  const std::vector<Points> path = PathAt(times);
  const FrameGrid grid = GridOf(times, 0);
  EXPECT_EQ(ResampleTracks(path, times, grid), path);
  EXPECT_EQ(ResamplePaths(path, times, grid), path);
  EXPECT_EQ(ResampleClouds(path, times, grid), path);
}

TEST(Resampling, TracksAreNotSeenInMissingFramesAndPathsGoOn) {
  std::vector<double> times = Times(30);
  times.erase(times.begin() + 7);
  const FrameGrid grid = GridOf(times, 0);
  const std::vector<Points> path = PathAt(times);
  const std::vector<Points> tracks = ResampleTracks(path, times, grid);
  EXPECT_TRUE(tracks[7].array().isNaN().all());
  EXPECT_EQ(tracks[6], path[6]);
  EXPECT_EQ(tracks[8], path[7]);
  EXPECT_TRUE(ResampleClouds(path, times, grid)[7].array().isNaN().all());
  EXPECT_LT((ResamplePaths(path, times, grid)[7] - PathAt(grid.Time(7))).cwiseAbs().maxCoeff(),
            1e-4);
}

TEST(Resampling, IsOfThirdOrderBetweenUnevenTimes) {
  double last = 1;
  for (int finer : {1, 2, 4}) {
    std::vector<double> times;
    for (int t = 0; t < 30 * finer; ++t) {
      times.push_back((t + (t > 0 ? 0.3 * std::sin(5.0 * t) : 0)) / kFps / finer);
    }
    const FrameGrid grid = GridOf(times, kFps * finer);
    const std::vector<Points> tracks = ResampleTracks(PathAt(times), times, grid);
    double worst = 0;
    for (int t = 2; t + 2 < grid.frames; ++t) {
      ASSERT_TRUE(tracks[t].allFinite());
      worst = std::max(worst, (tracks[t] - PathAt(grid.Time(t))).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst, last / 6);
    last = worst;
  }
  EXPECT_LT(last, 1e-5);
}

TEST(Resampling, APointThatIsNotSeenBesideAFrameIsNotSeenInIt) {
  const std::vector<double> times = Times(10);
  std::vector<Points> path = PathAt(times);
  path[4].col(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  const FrameGrid between{times[0] + 0.5 / kFps, kFps, 9};
  const std::vector<Points> tracks = ResampleTracks(path, times, between);
  for (int t = 0; t < 9; ++t) {
    EXPECT_TRUE(tracks[t].col(0).allFinite());
    EXPECT_EQ(tracks[t].col(1).allFinite(), t != 3 && t != 4);
  }
}

TEST(Resampling, PathsStandStillOutsideTheirTimes) {
  const std::vector<double> times = Times(10);
  const std::vector<Points> path = PathAt(times);
  const std::vector<Points> moved = ResamplePaths(path, times, {times[0] - 2 / kFps, kFps, 15});
  EXPECT_EQ(moved[0], path[0]);
  EXPECT_EQ(moved[1], path[0]);
  EXPECT_EQ(moved[14], path[9]);
}

TEST(Resampling, NumbersThatMayJumpAreTakenFromTheNearestTime) {
  const std::vector<Eigen::MatrixXd> measured(2, Eigen::MatrixXd::Ones(3, 1));
  const std::vector<Eigen::MatrixXd> frames = ResampleNumbers(measured, {0, 0.1}, {0, kFps, 6});
  EXPECT_EQ(frames[0], measured[0]);
  EXPECT_EQ(frames[5], measured[1]);
  EXPECT_TRUE(frames[2].array().isNaN().all());
}

}  // namespace
}  // namespace physpring
