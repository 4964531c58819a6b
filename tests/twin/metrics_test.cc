// SPDX-License-Identifier: Apache-2.0
#include "twin/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace physpring {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Points PointsOf(std::initializer_list<Eigen::Vector3d> columns) {
  Points points(3, static_cast<Eigen::Index>(columns.size()));
  Eigen::Index i = 0;
  for (const Eigen::Vector3d& column : columns) points.col(i++) = column;
  return points;
}

const Eigen::Vector3d kUnseen = Eigen::Vector3d::Constant(kNaN);

TEST(ChamferDistance, ChoosesTheNearestInItsOwnNorm) {
  // from the origin: (2, 2, 0) has L1 4 and length 2.83, (3.5, 0, 0) has L1 3.5 and length 3.5
  const Points predicted = PointsOf({{2, 2, 0}, {3.5, 0, 0}});
  const Points measured = PointsOf({{0, 0, 0}});
  EXPECT_DOUBLE_EQ(ChamferDistance(measured, predicted, Norm::kL1), 3.5);
  EXPECT_DOUBLE_EQ(ChamferDistance(measured, predicted, Norm::kEuclidean), std::sqrt(8));
}

TEST(ChamferDistance, GoesOneWayFromMeasuredToPredicted) {
  const Points predicted = PointsOf({{0, 0, 0}, {100, 0, 0}});  // the far one is near nothing
  EXPECT_DOUBLE_EQ(ChamferDistance(PointsOf({{0, 0, 1}, {0, 0, -2}}), predicted, Norm::kEuclidean),
                   1.5);
}

TEST(ChamferDistance, CountsOnlyWhatIsSeen) {
  const Points predicted = PointsOf({{0, 0, 0}});
  EXPECT_DOUBLE_EQ(ChamferDistance(PointsOf({kUnseen, {1, 1, 1}}), predicted, Norm::kL1), 3);
  EXPECT_TRUE(std::isnan(ChamferDistance(PointsOf({kUnseen}), predicted, Norm::kL1)));
}

TEST(ChamferDistance, AgreesWithAllPairs) {
  const Points predicted = Points::Random(3, 300), measured = Points::Random(3, 200);
  double l1 = 0, euclidean = 0;
  for (int i = 0; i < measured.cols(); ++i) {
    const Points difference = predicted.colwise() - measured.col(i);
    l1 += difference.cwiseAbs().colwise().sum().minCoeff() / 200;
    euclidean += difference.colwise().norm().minCoeff() / 200;
  }
  EXPECT_NEAR(ChamferDistance(measured, predicted, Norm::kL1), l1, 1e-14);
  EXPECT_NEAR(ChamferDistance(measured, predicted, Norm::kEuclidean), euclidean, 1e-14);
}

TEST(TrackError, IsTheMeanDistanceOfPairs) {
  const Points predicted = PointsOf({{0, 0, 0}, {1, 0, 0}});
  const Points measured = PointsOf({{1, 3, 4}, {0, 0, 2}, kUnseen, {9, 9, 9}});
  EXPECT_DOUBLE_EQ(TrackError(measured, predicted, {1, 0, 0, -1}), (5.0 + 2.0) / 2);
  EXPECT_TRUE(std::isnan(TrackError(PointsOf({kUnseen}), predicted, {0})));
  EXPECT_TRUE(std::isnan(TrackError(PointsOf({{0, 0, 0}}), predicted, {-1})));
}

// Two points and one interior particle in 3 frames; frame 1 has no data.
Recording ThreeFrames() {
  Recording recording;
  recording.points = {PointsOf({{0, 0, 0}, {1, 0, 0}}), PointsOf({kUnseen, kUnseen}),
                      PointsOf({{0, 0, 1}, kUnseen})};
  recording.controllers.assign(3, Points::Zero(3, 2));
  recording.interior = PointsOf({{0.5, 0, 0}});
  recording.velocity = Points::Zero(3, 3);
  recording.start = PointsOf({{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0, 0, 5}, {1, 0, 5}});
  recording.fps = 10;
  return recording;
}

TEST(NearestNodesAtStart, TakesTheRecordingsKeyPoints) {
  Recording recording = ThreeFrames();
  recording.track.assign(3, PointsOf({{0.9, 0, 0}, kUnseen, {0.4, 0, 0}}));
  EXPECT_EQ(NearestNodesAtStart(recording, recording.start.leftCols(3)),
            (std::vector<int>{1, -1, 2}));
  EXPECT_EQ(ParticlesOfTrack(recording), (std::vector<int>{1, -1, 2}));
}

TEST(NearestNodesAtStart, TakesThePointsWithoutKeyPoints) {
  const Recording recording = ThreeFrames();
  EXPECT_EQ(NearestNodesAtStart(recording, PointsOf({{0.2, 0, 0}})), (std::vector<int>{0, 0}));
  EXPECT_EQ(ParticlesOfTrack(recording), (std::vector<int>{0, 1}));
}

TEST(ComputeFrameErrors, LeavesFramesWithoutDataOut) {
  const Recording recording = ThreeFrames();
  const std::vector<Points> still(3, recording.start.leftCols(3));
  const FrameErrors errors = ComputeFrameErrors(recording, still, {1}, {0, 1});
  EXPECT_DOUBLE_EQ(errors.track[0], 0);
  EXPECT_DOUBLE_EQ(errors.track[2], 1);
  EXPECT_DOUBLE_EQ(errors.cd[2], 2);  // only node 1 is on the surface
  EXPECT_DOUBLE_EQ(errors.cd_euclidean[2], std::sqrt(2));
  EXPECT_TRUE(std::isnan(errors.cd[1]));
  EXPECT_TRUE(std::isnan(errors.track[1]));

  const MeanError mean = MeanOverFrames(errors.track, 1, 3);
  EXPECT_DOUBLE_EQ(mean.value.value(), 1);
  EXPECT_EQ(mean.frames, 1);
  EXPECT_EQ(mean.frames_without_data, 1);
}

TEST(ComputeFrameErrors, ComparesTheRecordingsSurface) {
  Recording recording = ThreeFrames();
  recording.surface.assign(3, PointsOf({{0, 0, 3}}));
  const std::vector<Points> still(3, recording.start.leftCols(3));
  EXPECT_DOUBLE_EQ(ComputeFrameErrors(recording, still, {0}, {0, 1}).cd[1], 3);
}

TEST(MeanOverFrames, IsEmptyWithoutData) {
  EXPECT_FALSE(MeanOverFrames({kNaN, kNaN}, 0, 2).value.has_value());
  EXPECT_EQ(MeanOverFrames({kNaN, kNaN}, 0, 2).frames_without_data, 2);
  EXPECT_FALSE(MeanOverFrames({1, 2}, 2, 2).value.has_value());
}

TEST(PublishedL1, IsTheProtocolOfTheCables) {
  // the source has T + 1 frames, of which the first two give the start: T - 1 are predicted
  Recording recording;
  recording.points = {PointsOf({{0, 0, 0}}), PointsOf({{1, -2, 3}}), PointsOf({{0, 0, 0.6}})};
  recording.controllers.assign(3, Points::Zero(3, 4));
  const std::vector<Points> still(3, PointsOf({{0, 0, 0}}));
  // 5 markers x 3 coordinates: 6 / 15 + 0.6 / 15, divided by 4
  EXPECT_DOUBLE_EQ(PublishedL1(recording, still).value(), (6.0 / 15 + 0.6 / 15) / 4);
}

TEST(PublishedL1, DoesNotCountWhatIsNotSeenAsExact) {
  Recording recording;
  recording.points = {PointsOf({{0, 0, 0}}), PointsOf({kUnseen}), PointsOf({{0, 0, 3}})};
  const std::vector<Points> still(3, PointsOf({{0, 0, 0}}));
  EXPECT_DOUBLE_EQ(PublishedL1(recording, still).value(), 1.0 * 2 / 4);
}

}  // namespace
}  // namespace physpring
