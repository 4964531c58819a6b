// SPDX-License-Identifier: Apache-2.0
// A swung cloth, of which each frame shows other points.
#include "registration/register_clouds.h"

#include <gtest/gtest.h>

#include "tests/support/clouded_cloth.h"
#include "tests/support/file_damage.h"
#include "twin/neighbours.h"
#include "twin/rotation.h"

namespace physpring {
namespace {

// Mean distance of the points from where the cloth's nearest points in frame 0 carry them, m.
double OffTruth(const Recording& registered, const Recording& truth) {
  const NeighbourSearch search(truth.points[0]);
  double sum = 0, count = 0;
  for (int i = 0; i < registered.point_count(); ++i) {
    std::vector<int> near;
    for (const Neighbour& one : search.Nearest(registered.points[0].col(i), 6)) {
      near.push_back(one.index);
    }
    for (int t = 1; t < kFrames; ++t) {
      const Eigen::Vector3d x = registered.points[t].col(i);
      if (!x.allFinite()) continue;
      const Points carried =
          MoveRigidly(truth.points[0](Eigen::all, near), truth.points[t](Eigen::all, near),
                      registered.points[0].col(i));
      sum += (x - carried.col(0)).norm();
      ++count;
    }
  }
  return sum / count;
}

double OwnMotion(const Recording& truth) {
  double sum = 0;
  for (const Points& frame : truth.points) {
    sum += (frame - truth.points[0]).colwise().norm().mean() / kFrames;
  }
  return sum;
}

TEST(RegisterClouds, FollowsPointsOfAClothWhoseCloudsHaveNoNames) {
  const Recording truth = SwungCloth(false);
  const RegisteredClouds registered = RegisterClouds(CloudsOf(truth, 1), 0);
  EXPECT_EQ(registered.recording.point_count(), 300);
  EXPECT_TRUE(registered.recording.points[0].allFinite());
  EXPECT_GT(registered.seen, 0.4);
  EXPECT_LT(registered.fit.distance, registered.fit.spacing);
  const double off = OffTruth(registered.recording, truth);
  EXPECT_LT(off, 0.4 * kSpacing);
  EXPECT_LT(off, 0.2 * OwnMotion(truth));
}

TEST(RegisterClouds, IsTheSameEachTime) {
  const Recording clouds = CloudsOf(SwungCloth(false), 1);
  const RegisteredClouds once = RegisterClouds(clouds, 60), again = RegisterClouds(clouds, 60);
  for (int t = 0; t < kFrames; ++t) {
    EXPECT_TRUE((once.recording.points[t].array().isNaN() ||
                 once.recording.points[t].array() == again.recording.points[t].array())
                    .all());
  }
}

TEST(RegisterClouds, TakesThePointsOfAnotherRecording) {
  const Recording first = SwungCloth(false), second = SwungCloth(true);
  const Recording known = RegisterClouds(CloudsOf(first, 1), 100).recording;
  const RegisteredClouds like = RegisterCloudsLike(CloudsOf(second, 2), known);
  ASSERT_EQ(like.recording.point_count(), 100);
  EXPECT_LT(like.fit.distance, like.fit.spacing);
  EXPECT_LT(OffTruth(like.recording, second), 0.4 * kSpacing);
  // the same points of the cloth: both recordings start at rest, in places that are known
  const Points placed = MoveRigidly(first.start, second.start, known.points[0]);
  EXPECT_LT((like.recording.points[0] - placed).colwise().norm().mean(), 0.4 * kSpacing);
}

// The camera sees one half of the cloth only; its shape says that there is another one.
TEST(RegisterClouds, SpreadsPointsOverAShapeThatIsKnown) {
  const Recording truth = SwungCloth(false);
  Recording clouds = CloudsOf(truth, 1);
  Points surface = clouds.surface[0];
  const double middle = surface.row(0).mean();
  for (Points& cloud : clouds.surface) {
    for (auto point : cloud.colwise()) {
      if (point[0] > middle) point.setConstant(std::nan(""));
    }
  }
  const Recording half = RegisterClouds(clouds, 60).recording;
  EXPECT_LT(half.points[0].row(0).maxCoeff(), middle + kSpacing);
  const RegisteredClouds registered = RegisterCloudsOn(clouds, surface, 120);
  ASSERT_EQ(registered.recording.point_count(), 120);
  EXPECT_NEAR(registered.recording.points[0].row(0).maxCoeff(), surface.row(0).maxCoeff(),
              kSpacing);
  EXPECT_EQ(registered.lost, std::nullopt);
  EXPECT_LT(OffTruth(registered.recording, truth), 0.4 * kSpacing);
}

// A few points that the camera saw elsewhere, in frame 0, are no part of the cloth.
TEST(RegisterClouds, LeavesOutFarPointsOfTheFirstCloud) {
  const Recording truth = SwungCloth(false);
  Recording clouds = CloudsOf(truth, 1);
  clouds.surface[0].col(5) << 3, 0, 0;
  clouds.surface[0].col(90) << 0, 0.5, 0.2;
  const RegisteredClouds registered = RegisterClouds(clouds, 100);
  EXPECT_EQ(registered.outliers, 2);
  EXPECT_EQ(registered.lost, std::nullopt);
  EXPECT_LT(OffTruth(registered.recording, truth), 0.4 * kSpacing);
}

// It takes its own points again.
TEST(RegisterClouds, IsLikeItself) {
  const Recording truth = SwungCloth(false), clouds = CloudsOf(truth, 1);
  const Recording known = RegisterClouds(clouds, 0).recording;
  const RegisteredClouds like = RegisterCloudsLike(clouds, known);
  EXPECT_EQ(like.lost, std::nullopt);
  EXPECT_LT(OffTruth(like.recording, truth), 0.4 * kSpacing);
}

TEST(RegisterClouds, SaysThatItIsLost) {
  Recording clouds = CloudsOf(SwungCloth(false), 1);
  for (std::size_t t = 40; t < clouds.surface.size(); ++t) clouds.surface[t].array() += 1;
  const int last = clouds.frame_count() - 1;
  EXPECT_EQ(RegisterClouds(clouds, 100).lost, (FrameSpan{40, last}));
}

TEST(RegisterClouds, SaysThatItIsLostForAWhile) {
  Recording clouds = CloudsOf(SwungCloth(false), 1);
  constexpr int kFirst = 10, kEnd = 25;
  for (int t = kFirst; t < kEnd; ++t) clouds.surface[static_cast<std::size_t>(t)].array() += 1;
  EXPECT_EQ(RegisterClouds(clouds, 100).lost, (FrameSpan{kFirst, kEnd - 1}));
}

TEST(RegisterClouds, RefusesWhatIsNoBody) {
  Recording clouds = CloudsOf(SwungCloth(false), 1);
  const Recording known = SwungCloth(true);
  clouds.surface[0] = clouds.surface[0].leftCols(7).eval();
  const std::string few =
      "recording cloth: array 'surface' has 7 points in frame 0, expected 8 or more";
  EXPECT_EQ(ErrorOf("recording cloth", [&] { RegisterClouds(clouds, 0); }), few);
  EXPECT_EQ(ErrorOf("recording cloth", [&] { RegisterCloudsLike(clouds, known); }), few);
  const Recording sound = CloudsOf(SwungCloth(false), 1);
  EXPECT_EQ(ErrorOf("recording cloth", [&] { RegisterClouds(sound, 7); }),
            "recording cloth: 7 points make no body, expected 8 or more");
  clouds.surface.clear();
  EXPECT_EQ(ErrorOf("recording cloth", [&] { RegisterClouds(clouds, 0); }),
            "recording cloth: has no clouds ('surface')");
}

TEST(RegisterClouds, NeedsTheSameNumberOfControllers) {
  const Recording clouds = CloudsOf(SwungCloth(false), 1);
  Recording known = SwungCloth(true);
  for (Points& hands : known.controllers) hands = hands.leftCols(1).eval();
  EXPECT_EQ(
      ErrorOf("recording cloth", [&] { RegisterCloudsLike(clouds, known); }),
      "recording cloth: has 2 controllers, but turned has 1; expected recordings of one object");
}

}  // namespace
}  // namespace physpring
