// SPDX-License-Identifier: Apache-2.0
// Pictures in other sizes. That the bytes are Pillow's is shown in openpi_policies_test.py.
#include "rollout/picture_size.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

Image Plain(int width, int height, unsigned char value) {
  return {width, height, std::vector<unsigned char>(std::size_t{3} * width * height, value)};
}

int Red(const Image& image, int row, int column) {
  return image.rgb[std::size_t{3} * (row * image.width + column)];
}

TEST(PictureSize, SameSizeChangesNothing) {
  Image image = Plain(5, 4, 0);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<unsigned char>(i);
  EXPECT_EQ(ResizeWithPad(image, 5, 4).rgb, image.rgb);
}

TEST(PictureSize, BarsFillWhatAnotherRatioLeaves) {
  const Image square = ResizeWithPad(Plain(64, 48, 200), 32, 32);  // 32 x 24 inside
  ASSERT_EQ(square.rgb.size(), 3U * 32 * 32);
  for (int row = 0; row < 32; ++row) {
    EXPECT_EQ(Red(square, row, 16), row >= 4 && row < 28 ? 200 : 0) << row;
  }
}

TEST(PictureSize, AHalfIsTheTriangleMeanOfItsPixels) {
  Image row = Plain(8, 1, 0);
  for (int colour = 0; colour < 3; ++colour) row.rgb[3 * 3 + colour] = 128;  // pixel 3
  const Image half = ResizeWithPad(row, 4, 1);
  // pixel 1 covers 2 and 3, with 3/8 each, and 1 and 4, with 1/8 each
  EXPECT_EQ(Red(half, 0, 1), 48);
  EXPECT_EQ(Red(half, 0, 2), 16);
  EXPECT_EQ(Red(half, 0, 3), 0);
}

TEST(PictureSize, MirrorTwiceIsTheSame) {
  Image image = Plain(3, 2, 0);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<unsigned char>(i);
  EXPECT_EQ(Red(Mirror(image), 1, 0), Red(image, 1, 2));
  EXPECT_EQ(Mirror(Mirror(image)).rgb, image.rgb);
}

}  // namespace
}  // namespace physpring
