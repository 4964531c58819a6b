// SPDX-License-Identifier: Apache-2.0
// Derivatives of pictures of splats against central differences, and the pictures against those of
// the rasteriser.
#include "splats/fit/picture_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "splats/rasterise.h"
#include "tests/support/gradient_check.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

PinholeCamera SmallCamera() {
  PinholeCamera camera{20, 18};
  camera.axes = Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.2, 1, -0.1).normalized()).matrix();
  camera.shift = {0.02, -0.01, 1.2};
  camera.fx = 24;
  camera.fy = 22;
  camera.cx = 10.5;
  camera.cy = 8;
  return camera;
}

// So wide that the picture ends before they do, so that no pixel is at an edge of one, where the
// formula jumps.
FreeSplats WideSplats(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double from, double to) {
    return from + (to - from) * Uniform(&random);
  };
  FreeSplats splats(FreeSplats::RowsAtCompileTime, count);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) splats(kFreePosition + k, i) = between(-0.2, 0.2);
    for (int k = 0; k < 3; ++k) splats(kFreeScale + k, i) = between(-0.7, -0.1);
    for (int k = 0; k < 4; ++k) splats(kFreeRotation + k, i) = between(-1, 1);
    splats(kFreeLogit, i) = between(-1, 0.3);
    for (int k = 0; k < 3; ++k) splats(kFreeColour + k, i) = between(0.1, 1);
  }
  return splats;
}

// Some loss in which each pixel and channel counts differently.
double SomeLoss(std::size_t place, const Pixel& pixel, Pixel* bar) {
  const double phase = 0.7 * static_cast<double>(place);
  const Eigen::Vector3d weight(std::sin(phase), std::cos(phase), 1);
  const double covered = std::sin(1.3 * phase);
  bar->colour = weight + 2 * pixel.colour;
  bar->coverage = covered + 0.5 * pixel.coverage;
  return weight.dot(pixel.colour) + pixel.colour.squaredNorm() + covered * pixel.coverage +
         0.25 * pixel.coverage * pixel.coverage;
}

void ExpectDerivativesMatch(FreeSplats splats) {
  const PinholeCamera camera = SmallCamera();
  FreeSplats gradient = FreeSplats::Zero(FreeSplats::RowsAtCompileTime, splats.cols());
  AddPictureLoss(splats, camera, SomeLoss, 2, &gradient);
  const auto loss = [&]() -> long double {
    long double sum = 0;  // pixel by pixel: rounding is most of the error of a difference
    FreeSplats unused = gradient;
    std::vector<double> parts(static_cast<std::size_t>(camera.width) * camera.height);
    AddPictureLoss(
        splats, camera,
        [&](std::size_t place, const Pixel& pixel, Pixel* bar) {
          return parts[place] = SomeLoss(place, pixel, bar);
        },
        1, &unused);
    for (const double part : parts) sum += part;
    return sum;
  };
  std::vector<CheckedVariable> variables;
  for (int i = 0; i < splats.cols(); ++i) {
    for (int row = 0; row < kFreeRows; ++row) {
      variables.push_back({"splat " + std::to_string(i) + " row " + std::to_string(row),
                           &splats(row, i), 1e-3, gradient(row, i)});
    }
  }
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
}

TEST(PictureLoss, DerivativesAreThoseOfDifferences) { ExpectDerivativesMatch(WideSplats(7, 3)); }

TEST(PictureLoss, DerivativesOfSplatsFarAside) {
  FreeSplats splats = WideSplats(2, 4);
  splats.middleRows<3>(kFreeScale).array() += 1;
  // outside of 1.3 times the picture, where their shape no longer depends on how far aside they are
  splats(kFreePosition, 0) = 0.9;
  splats(kFreePosition + 1, 1) = -0.9;
  ExpectDerivativesMatch(splats);
}

TEST(PictureLoss, PicturesAreThoseOfTheRasteriser) {
  FreeSplats splats = WideSplats(300, 5);
  splats.middleRows<3>(kFreeScale).array() -= 2.5;  // with edges, and tiles without some
  splats.row(kFreeLogit).array() += 3;              // opaque ones
  PinholeCamera camera = SmallCamera();
  camera.width = 90;
  camera.height = 70;
  camera.fx = camera.fy = 110;
  camera.cx = 44;
  camera.cy = 36;
  const SplatPicture picture = Rasterise(AsStored(StoredSplats(splats)), camera, {}, 1);
  FreeSplats gradient = FreeSplats::Zero(FreeSplats::RowsAtCompileTime, splats.cols());
  double worst = 0, most = 0;
  AddPictureLoss(
      splats, camera,
      [&](std::size_t place, const Pixel& pixel, Pixel*) {
        for (int k = 0; k < 3; ++k) {
          worst = std::max(
              worst, std::abs(pixel.colour[k] - static_cast<double>(picture.rgb[3 * place + k])));
        }
        most = std::max(most, pixel.coverage);
        return 0.0;
      },
      1, &gradient);
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(most, 0.99);
}

TEST(PictureLoss, ThreadsDoNotChangeABit) {
  const FreeSplats splats = WideSplats(50, 6);
  PinholeCamera camera = SmallCamera();
  camera.width = camera.height = 60;
  FreeSplats one = FreeSplats::Zero(FreeSplats::RowsAtCompileTime, splats.cols()), many = one;
  const double loss_of_one = AddPictureLoss(splats, camera, SomeLoss, 1, &one);
  EXPECT_EQ(AddPictureLoss(splats, camera, SomeLoss, 5, &many), loss_of_one);
  EXPECT_EQ(one, many);
}

}  // namespace
}  // namespace physpring
