// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/clouds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace physpring {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kFrames = 20;

// A sheet of 0.3 m x 0.4 m under two hands.
Recording Sheet() {
  Recording recording;
  recording.fps = 30;
  Points sheet(3, 30), hands(3, 2);
  for (int i = 0; i < 30; ++i) sheet.col(i) << 0.06 * (i % 6), 0.1 * (i / 6), 0.5;
  hands << 0, 0.3, -0.05, -0.05, 0.5, 0.5;
  recording.surface.assign(kFrames, sheet);
  recording.controllers.assign(kFrames, hands);
  recording.points.assign(kFrames, Points(3, 0));
  return recording;
}

TEST(Clouds, AreNotOdd) {
  Recording sheet = Sheet();
  sheet.ground = Eigen::Vector4d(0, 0, 1, 0.48);
  sheet.surface[0].col(7) << 40, 0, 0;  // a false point
  EXPECT_THAT(FindOddClouds(sheet), IsEmpty());
}

TEST(Clouds, AreMissing) {
  Recording sheet = Sheet();
  for (int t = 15; t < kFrames; ++t) sheet.surface[static_cast<std::size_t>(t)].setConstant(NAN);
  EXPECT_THAT(FindOddClouds(sheet), ElementsAre("5 of 20 frames have no cloud"));
}

TEST(Clouds, StandStillWhileHandsMove) {
  Recording sheet = Sheet();
  for (int t = 12; t < kFrames; ++t) {
    sheet.controllers[static_cast<std::size_t>(t)].row(2).array() += 0.01 * t;
  }
  EXPECT_THAT(FindOddClouds(sheet),
              ElementsAre("8 frames, the first is 12, have exactly the cloud of the frame before, "
                          "while controllers move: did the camera stop, or were frames recorded "
                          "twice?"));
  for (std::size_t t = 0; t < kFrames; ++t) sheet.surface[t](2, 3) += 1e-9 * static_cast<double>(t);
  EXPECT_THAT(FindOddClouds(sheet), IsEmpty());
}

TEST(Clouds, AreInMillimetres) {
  Recording sheet = Sheet();
  for (Points& cloud : sheet.surface) cloud *= 1e3;
  for (Points& hands : sheet.controllers) hands *= 1e3;
  EXPECT_THAT(FindOddClouds(sheet),
              ElementsAre("the first cloud measures 500 m: are positions in metres?"));
}

TEST(Clouds, AreBelowTheGround) {
  Recording sheet = Sheet();
  sheet.ground = Eigen::Vector4d(0, 0, 1, 0.6);
  EXPECT_THAT(FindOddClouds(sheet), ElementsAre("the object starts 0.1 m below the ground"));
}

TEST(Clouds, AreFarFromTheHands) {
  Recording sheet = Sheet();
  for (Points& hands : sheet.controllers) hands(2, 1) += 1;
  EXPECT_THAT(
      FindOddClouds(sheet),
      ElementsAre("a controller is 1 m from the first cloud, which measures 0.5 m: are both "
                  "in the same coordinates?"));
}

TEST(Clouds, AreFilledUpWithZeros) {
  Recording sheet = Sheet();
  sheet.surface[0].col(0).setZero();
  EXPECT_EQ(TakeFillingAsNone("sheet.npz", &sheet.surface), "");  // one may be a point
  sheet.surface[3].rightCols(4).setZero();
  EXPECT_EQ(TakeFillingAsNone("sheet.npz", &sheet.surface),
            "sheet.npz: 5 points are exactly at (0, 0, 0), taken as none");
  EXPECT_TRUE(sheet.surface[0].col(0).array().isNaN().all());
  EXPECT_TRUE(sheet.surface[3].rightCols(4).array().isNaN().all());
  EXPECT_TRUE(sheet.surface[4].allFinite());
}

TEST(Clouds, AreFilledUpWithAConstant) {
  Recording sheet = Sheet();
  for (std::size_t t = 2; t < sheet.surface.size(); ++t) {
    sheet.surface[t].rightCols(3).setConstant(-1);
  }
  sheet.surface[1].rightCols(1).setConstant(-1);  // alone there
  const auto frames = static_cast<int>(sheet.surface.size());
  EXPECT_EQ(TakeFillingAsNone("sheet.npz", &sheet.surface),
            "sheet.npz: " + std::to_string(3 * (frames - 2) + 1) +
                " points are exactly at (-1, -1, -1), taken as none");
  EXPECT_TRUE(sheet.surface[2].rightCols(3).array().isNaN().all());
  EXPECT_TRUE(sheet.surface[1].rightCols(1).array().isNaN().all());
  EXPECT_TRUE(sheet.surface[0].allFinite());
}

TEST(Clouds, AreFilledUpWithTheirLastPoint) {
  Recording sheet = Sheet();
  Points& cloud = sheet.surface[2];
  const Eigen::Index last = cloud.cols() - 1;
  cloud.rightCols(3).colwise() = Eigen::Vector3d(cloud.col(last - 3));
  EXPECT_EQ(TakeFillingAsNone("sheet.npz", &sheet.surface),
            "sheet.npz: 3 points are there more than once in a frame, taken once");
  EXPECT_TRUE(cloud.leftCols(last - 2).allFinite());
  EXPECT_TRUE(cloud.rightCols(3).array().isNaN().all());
}

}  // namespace
}  // namespace physpring
