// SPDX-License-Identifier: Apache-2.0
// The measures against scikit-image 0.26: structural_similarity(..., channel_axis=2,
// gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=255) and
// peak_signal_noise_ratio, of the same pictures with five black pixels around them (what it leaves
// out of its mean).
#include "pictures/image_errors.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

constexpr int kWidth = 40, kHeight = 32;

// A pattern in a part of a black picture, which touches the picture's edge.
Image Pattern(int seed) {
  Image image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        const bool inside = x >= seed && x < 30 + seed && y >= 6 && y < 25;
        const int value = (x * (7 + seed) + y * (13 - seed) + c * 31 + (x * y) % (17 + seed)) % 256;
        image.rgb.push_back(static_cast<unsigned char>(inside ? value : 0));
      }
    }
  }
  return image;
}

constexpr PixelBox kWhole{0, 0, kWidth, kHeight}, kObjectBox{0, 6, 30, 25};

TEST(ImageErrors, AreThoseOfScikitImage) {
  const Image one = Pattern(0), other = Pattern(2);
  EXPECT_NEAR(Psnr(one, other, kWhole), 13.633730547793233, 1e-4);
  EXPECT_NEAR(Ssim(one, other, kWhole), 0.6828317806378932, 1e-4);
  EXPECT_NEAR(Psnr(one, other, kObjectBox), 11.468722946013587, 1e-4);
  EXPECT_NEAR(Ssim(one, other, kObjectBox), 0.6117633834553093, 1e-4);
}

TEST(ImageErrors, OfTheSamePictureAreNone) {
  const Image one = Pattern(1);
  EXPECT_EQ(Psnr(one, one, kWhole), kMostPsnr);
  EXPECT_NEAR(Ssim(one, one, kWhole), 1, 1e-12);
  const Image black{kWidth, kHeight, std::vector<unsigned char>(one.rgb.size())};
  EXPECT_EQ(Ssim(black, black, kWhole), 1);
}

// A picture of one row.
struct Row {
  Image predicted{6, 1, std::vector<unsigned char>(18, 100)};
  Image recorded{6, 1, std::vector<unsigned char>(18, 100)};
  std::vector<float> coverage{1, 1, 0.4F, 1, 0, 1};
  Mask mask{6, 1, {kObject, kElsewhere, kObject, kHidden, kElsewhere, kObject}};
};

TEST(CompareImages, CountsMasksWhereTheObjectIsNotHidden) {
  const Row row;
  const auto errors = CompareImages(row.predicted, row.coverage, row.recorded, row.mask);
  EXPECT_DOUBLE_EQ(errors->iou, 2.0 / 4);  // of the pixels 0, 1, 2, 5 the first and the last
}

TEST(CompareImages, LeavesOutWhatIsHidden) {
  Row row;
  row.predicted.rgb.assign(18, 0);
  row.recorded.rgb.assign(18, 0);
  row.predicted.rgb[9] = row.recorded.rgb[10] = 250;  // of the hidden pixel
  EXPECT_EQ(CompareImages(row.predicted, row.coverage, row.recorded, row.mask)->psnr, kMostPsnr);
  row.recorded.rgb[4] = 250;  // not the object's
  EXPECT_EQ(CompareImages(row.predicted, row.coverage, row.recorded, row.mask)->psnr, kMostPsnr);
  row.predicted.rgb[4] = 250;  // but it is predicted to be
  EXPECT_LT(CompareImages(row.predicted, row.coverage, row.recorded, row.mask)->psnr, 50);
}

TEST(CompareImages, SaysNothingWhereTheObjectIsNotSeen) {
  Row row;
  row.mask.kind = {kElsewhere, kHidden, kElsewhere, kHidden, kElsewhere, kElsewhere};
  EXPECT_FALSE(CompareImages(row.predicted, row.coverage, row.recorded, row.mask).has_value());
}

}  // namespace
}  // namespace physpring
