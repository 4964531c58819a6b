// SPDX-License-Identifier: Apache-2.0
#include "rollout/painter.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <numeric>
#include <thread>

#include "rollout/scene.h"
#include "tests/support/drawing.h"
#include "tests/support/temporary_folder.h"

namespace physpring {
namespace {

constexpr int kWidth = 64, kHeight = 48;

// A red ball above a green one, seen from the side.
const char* const kScene = R"(
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <geom type="sphere" size="0.3" pos="0 0 0.4" rgba="1 0 0 1"/>
    <geom type="sphere" size="0.3" pos="0 0 -0.4" rgba="0 1 0 1"/>
    <camera name="side" pos="0 -2 0" xyaxes="1 0 0 0 0 1"/>
  </worldbody>
</mujoco>)";

class PainterTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = WhyNoDrawing(); !why.empty()) GTEST_SKIP() << why;
    std::ofstream(folder_.File("scene.xml")) << kScene;
  }

  Image Paint(PictureQuality quality) const {
    std::vector<std::string> warnings;
    const ModelPtr model = LoadScene(folder_.File("scene.xml"), &warnings);
    PreparePictures(quality, kWidth, kHeight, model.get());
    const DataPtr data = MakeData(*model);
    mj_forward(model.get(), data.get());
    Painter painter(*model, quality, kWidth, kHeight);
    return painter.Paint(data.get(), FindCamera(*model, "side", "scene.xml"));
  }

  TemporaryFolder folder_;
};

std::array<int, 3> Pixel(const Image& image, int x, int y) {
  const unsigned char* rgb = image.rgb.data() + 3 * (y * image.width + x);
  return {rgb[0], rgb[1], rgb[2]};
}

TEST_F(PainterTest, TopOfThePictureIsUp) {
  for (const PictureQuality quality : {PictureQuality::kFast, PictureQuality::kHigh}) {
    const Image image = Paint(quality);
    ASSERT_EQ(image.rgb.size(), 3u * kWidth * kHeight);
    const auto above = Pixel(image, kWidth / 2, kHeight / 4);
    const auto below = Pixel(image, kWidth / 2, 3 * kHeight / 4);
    EXPECT_GT(above[0], 150);
    EXPECT_LT(above[1], 50);
    EXPECT_GT(below[1], 150);
    EXPECT_LT(below[0], 50);
  }
}

TEST_F(PainterTest, PicturesAreTheSameInEveryThread) {
  const Image here = Paint(PictureQuality::kFast);
  Image there;
  std::thread([&] { there = Paint(PictureQuality::kFast); }).join();
  EXPECT_EQ(here.rgb, there.rgb);
}

}  // namespace
}  // namespace physpring
