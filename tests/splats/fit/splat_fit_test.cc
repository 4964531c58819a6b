// SPDX-License-Identifier: Apache-2.0
// Splats fitted to pictures that splats made.
#include "splats/fit/splat_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "splats/fit/free_splats.h"
#include "splats/picture_bytes.h"
#include "splats/rasterise.h"
#include "tests/support/temporary_folder.h"
#include "twin/error.h"

namespace physpring {
namespace {

// A sheet of 0.3 x 0.2 m at z = 0, with a pattern, of splats that hide what is behind.
FreeSplats PatternedSheet() {
  constexpr int kColumns = 60, kRows = 40;
  FreeSplats splats(FreeSplats::RowsAtCompileTime, kColumns * kRows);
  for (int i = 0; i < splats.cols(); ++i) {
    const double x = (i % kColumns - 29.5) * 0.005, y = (i / kColumns - 19.5) * 0.005;
    const double red = 0.5 + 0.4 * std::sin(60 * x), green = 0.5 + 0.4 * std::cos(50 * y);
    splats.col(i) << x, y, 0, std::log(0.003), std::log(0.003), std::log(0.0006), 1, 0, 0, 0, 4,
        red, green, 0.7;
  }
  return splats;
}

RecordedCamera LookingAt(const std::string& name, const Eigen::Vector3d& from) {
  RecordedCamera camera{name, {96, 72}};
  const Eigen::Vector3d forward = -from.normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
  camera.view.axes.row(0) = right.transpose();
  camera.view.axes.row(1) = forward.cross(right).transpose();
  camera.view.axes.row(2) = forward.transpose();
  camera.view.shift = -camera.view.axes * from;
  camera.view.fx = camera.view.fy = 110;
  camera.view.cx = 48;
  camera.view.cy = 36;
  return camera;
}

class FitSplatsTest : public ::testing::Test {
 protected:
  // Two cameras that it is fitted to, a third between them.
  FitSplatsTest()
      : pictures_(folder_.path(), 30, 1, 1e-4,
                  {LookingAt("left", {-0.2, 0.1, 0.4}), LookingAt("right", {0.2, 0.1, 0.4}),
                   LookingAt("above", {0, 0.25, 0.4})}) {
    pictures_.MakeFolders();
    pictures_.WriteCameras();
    const Splats splats = StoredSplats(PatternedSheet());
    for (int i = 0; i < 3; ++i) {
      const PinholeCamera& view = pictures_.cameras()[i].view;
      const SplatPicture picture = Rasterise(AsStored(splats), view, {}, 1);
      Mask mask{view.width, view.height, {}};
      DepthImage depth{view.width, view.height, {}};
      for (int pixel = 0; pixel < view.width * view.height; ++pixel) {
        const bool is_object = picture.coverage[pixel] > 0.5F;
        mask.kind.push_back(is_object ? kObject : kElsewhere);
        depth.metres.push_back(is_object ? DepthAt(view, pixel) : 0);
      }
      pictures_.Write(i, 0, BytesOf(picture));
      pictures_.Write(i, 0, mask);
      pictures_.Write(i, 0, depth);
    }
  }

  // Of the plane z = 0.
  static float DepthAt(const PinholeCamera& view, int pixel) {
    const Eigen::Vector3d ray((pixel % view.width + 0.5 - view.cx) / view.fx,
                              (pixel / view.width + 0.5 - view.cy) / view.fy, 1);
    return static_cast<float>(-view.centre().z() / (view.axes.transpose() * ray).z());
  }

  TemporaryFolder folder_;
  PictureFolder pictures_;
};

TEST_F(FitSplatsTest, LooksAsRecordedAlsoFromElsewhere) {
  const SplatFit start = FitSplats(pictures_, {.cameras = {0, 1}, .count = 1500, .iterations = 0});
  const SplatFit fit =
      FitSplats(pictures_, {.cameras = {0, 1}, .count = 1500, .iterations = 150, .threads = 2});
  EXPECT_NEAR(fit.splats.count(), 1500, 50);
  EXPECT_LT(fit.loss, 0.2 * fit.first_loss);
  for (int camera = 0; camera < 3; ++camera) {
    EXPECT_GT(fit.errors[camera]->iou, 0.95) << camera;
    EXPECT_GT(fit.errors[camera]->psnr, camera < 2 ? 30 : 28) << camera;
    EXPECT_GT(fit.errors[camera]->psnr, start.errors[camera]->psnr + 3) << camera;
  }
}

TEST_F(FitSplatsTest, ThreadsDoNotChangeABit) {
  const SplatFit one = FitSplats(pictures_, {.count = 300, .iterations = 5, .threads = 1});
  const SplatFit many = FitSplats(pictures_, {.count = 300, .iterations = 5, .threads = 4});
  EXPECT_EQ(one.splats.position, many.splats.position);
  EXPECT_EQ(one.splats.harmonics, many.splats.harmonics);
}

TEST_F(FitSplatsTest, RefusesWhatCannotBeFitted) {
  const auto message = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing is refused";
  };
  EXPECT_THAT(message([&] { FitSplats(pictures_, {.frame = 1}); }),
              ::testing::HasSubstr("has no frame 1; its last is 0"));
  const Mask nothing{96, 72, std::vector<unsigned char>(96 * 72, kElsewhere)};
  for (int i = 0; i < 3; ++i) pictures_.Write(i, 0, nothing);
  EXPECT_THAT(message([&] { FitSplats(pictures_, {}); }),
              ::testing::HasSubstr("no camera sees the object, or how far it is, in frame 0"));
  const PictureFolder flat(folder_.path(), 30, 1, 0, pictures_.cameras());
  EXPECT_THAT(message([&] { FitSplats(flat, {}); }), ::testing::HasSubstr("has no depth"));
}

}  // namespace
}  // namespace physpring
