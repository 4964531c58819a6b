// SPDX-License-Identifier: Apache-2.0
// Pictures of a sheet that a hand lifts, by a camera above it, with a ball between.
#include "rollout/record_pictures.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/rollout/record_scene.h"
#include "tests/support/drawing.h"

namespace physpring {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 160, kHeight = 120;

constexpr char kBall[] = R"(<geom name="ball" type="sphere" size="0.004" pos="0.005 0.003 0.7"
                                  contype="0" conaffinity="0"/>)";
constexpr char kCameras[] = R"(
  <camera name="above" pos="0 0 0.9" xyaxes="1 0 0 0 1 0" fovy="30"/>
  <camera name="wide" pos="0.3 -0.4 0.9" xyaxes="0.8 0.6 0 -0.3 0.4 0.8" fovy="50"/>
  <camera name="flat" pos="0 0 0.9" projection="orthographic" fovy="0.2"/>
  <camera name="../out" pos="0 0 0.9"/>
  <body name="cart" mocap="true"><camera name="moving" pos="0 0 1"/></body>)";

class RecordPictures : public SceneTest {
 protected:
  void SetUp() override {
    if (const std::string why = WhyNoDrawing(); !why.empty()) GTEST_SKIP() << why;
  }

  Recording Record(const std::vector<std::string>& cameras) const {
    // the cart has a place in each key, too
    std::string keys = kLift;
    for (std::size_t at = 0; (at = keys.find("mpos=\"", at)) != std::string::npos;) {
      at = keys.find('"', at + 6);
      keys.insert(at, " 0 0 0");
    }
    RecordOptions options;
    options.duration = 0.1;
    options.pictures = {folder_.File("seen"), cameras, kWidth, kHeight, PictureQuality::kFast};
    const std::string bodies = fmt::format("{}{}{}", kSheet, kBall, kCameras);
    return RecordScene(WriteScene(Scene(bodies, kTwoTies, keys)), options);
  }

  std::string MessageOf(const std::vector<std::string>& cameras) const {
    try {
      Record(cameras);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing is refused";
  }
};

// Where the camera has a point: pixel and depth.
Eigen::Vector3d Seen(const PinholeCamera& view, const Eigen::Vector3d& point) {
  const Eigen::Vector3d t = view.axes * point + view.shift;
  return {view.fx * t.x() / t.z() + view.cx, view.fy * t.y() / t.z() + view.cy, t.z()};
}

TEST_F(RecordPictures, PointsAreWhereTheCamerasSeeThem) {
  const Recording recording = Record({"above", "wide"});
  const PictureFolder pictures(folder_.File("seen"));
  EXPECT_EQ(pictures.frame_count(), recording.frame_count());
  EXPECT_EQ(pictures.fps(), recording.fps);
  int compared = 0;
  for (int camera = 0; camera < 2; ++camera) {
    const PinholeCamera& view = pictures.cameras()[camera].view;
    for (int frame = 0; frame < recording.frame_count(); ++frame) {
      const Mask mask = pictures.ReadObjectMask(camera, frame);
      const DepthImage depth = pictures.ReadDepthImage(camera, frame);
      const Points& points = recording.points[frame];
      for (const int i : {3, 4, 7, 8, 11, 12}) {  // those that are not at the sheet's edge
        const Eigen::Vector3d seen = Seen(view, points.col(i));
        const int place = static_cast<int>(seen.y()) * kWidth + static_cast<int>(seen.x());
        EXPECT_NE(mask.kind[place], kElsewhere) << camera << " " << frame << " " << i;
        if (mask.kind[place] != kObject || frame > 0) continue;
        // flat now: 2 mm thick, for the second camera slanted within a pixel
        EXPECT_NEAR(depth.metres[place], seen.z(), camera == 0 ? 0.0025 : 0.009) << camera << i;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 8);
}

TEST_F(RecordPictures, WhatIsInFrontHides) {
  Record({"above"});
  const PictureFolder pictures(folder_.File("seen"));
  const Mask mask = pictures.ReadObjectMask(0, 0);
  const Eigen::Vector3d ball = Seen(pictures.cameras()[0].view, {0.005, 0.003, 0.7});
  const int place = static_cast<int>(ball.y()) * kWidth + static_cast<int>(ball.x());
  EXPECT_EQ(mask.kind[place], kHidden);
  EXPECT_NEAR(pictures.ReadDepthImage(0, 0).metres[place], 0.9 - 0.704, 0.002);
  // the ball, of 4 mm at 0.2 m, has as many pixels as a circle of its size
  const double radius = pictures.cameras()[0].view.fx * 0.004 / 0.2;
  int hidden = 0;  // around it; the hand hides a corner of the sheet, too
  for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
    const Eigen::Vector2d off(pixel % kWidth + 0.5 - ball.x(), pixel / kWidth + 0.5 - ball.y());
    hidden += mask.kind[pixel] == kHidden && off.norm() < 2 * radius ? 1 : 0;
  }
  EXPECT_NEAR(hidden, EIGEN_PI * radius * radius, 0.15 * hidden);
}

TEST_F(RecordPictures, CamerasMustBeThereAndStand) {
  EXPECT_THAT(MessageOf({"below"}), HasSubstr("has no camera 'below'"));
  EXPECT_THAT(MessageOf({"above", "moving"}), HasSubstr("camera 'moving' moves"));
  EXPECT_THAT(MessageOf({"flat"}), HasSubstr("camera 'flat' has no perspective"));
  EXPECT_THAT(MessageOf({"above", "above"}), HasSubstr("camera 'above' is named twice"));
  EXPECT_THAT(MessageOf({"../out"}), HasSubstr("cannot have a folder of pictures"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("seen")));
}

TEST_F(RecordPictures, WhatIsStoppedLeavesNone) {
  const std::string scene = WriteScene(Scene(std::string(kSheet) + kCameras, kTwoTies, kLift));
  std::vector<std::string> warnings;
  const ModelPtr model = LoadScene(scene, &warnings);
  PreparePictures(PictureQuality::kFast, kWidth, kHeight, model.get());
  const SoftPoints soft = FindSoftPoints(*model, scene);
  const DataPtr data = MakeData(*model);
  const PictureOptions options{
      folder_.File("seen"), {"above"}, kWidth, kHeight, PictureQuality::kFast};
  {
    PictureRecorder recorder(*model, soft, options, scene);
    recorder.Record(0, *data);
    EXPECT_TRUE(std::filesystem::exists(folder_.File("seen/color/above/00000.png")));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.File("seen")));
}

TEST_F(RecordPictures, PointsAreTheSameWithoutThem) {
  const Recording with = Record({"above"});
  RecordOptions options;
  options.duration = 0.1;
  const Recording without = RecordScene(folder_.File("scene.xml"), options);
  ASSERT_EQ(with.frame_count(), without.frame_count());
  for (int frame = 0; frame < with.frame_count(); ++frame) {
    EXPECT_EQ(with.points[frame], without.points[frame]) << frame;
  }
}

}  // namespace
}  // namespace physpring
