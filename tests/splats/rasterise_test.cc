// SPDX-License-Identifier: Apache-2.0
// The rasteriser against the published formula, written down plainly in double precision: each
// pixel looks at all splats, from the nearest to the farthest.
#include "splats/rasterise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "splats/harmonics.h"
#include "splats/tile.h"
#include "tests/splats/random_splats.h"

namespace physpring {
namespace {

PinholeCamera Camera(int width, int height) {
  PinholeCamera camera{width, height};
  camera.axes = Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.2, 1, -0.1).normalized()).matrix();
  camera.shift = {0.05, -0.1, 1.2};
  camera.fx = camera.fy = 1.1 * height;
  camera.cx = 0.5 * width + 1.5;
  camera.cy = 0.5 * height - 2;
  return camera;
}

// One splat as a camera sees it, in double.
struct Seen {
  double depth, opacity;
  Eigen::Vector2d centre;
  Eigen::Matrix2d inverse;
  Eigen::Vector3d colour;
};

Seen Look(const PlacedSplats& splats, int i, const PinholeCamera& camera) {
  const Eigen::Vector3d p = splats.position.col(i).cast<double>();
  const Eigen::Vector3d t = camera.axes * p + camera.shift;
  const auto s = splats.covariance.col(i).cast<double>();
  Eigen::Matrix3d covariance;
  covariance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  const double x = std::clamp(t.x() / t.z(), -1.3 * camera.cx / camera.fx,
                              1.3 * (camera.width - camera.cx) / camera.fx);
  const double y = std::clamp(t.y() / t.z(), -1.3 * camera.cy / camera.fy,
                              1.3 * (camera.height - camera.cy) / camera.fy);
  Eigen::Matrix<double, 2, 3> j;
  j << camera.fx / t.z(), 0, -camera.fx * x / t.z(), 0, camera.fy / t.z(), -camera.fy * y / t.z();
  const Eigen::Matrix2d s2 =
      j * camera.axes * covariance * camera.axes.transpose() * j.transpose() +
      0.3 * Eigen::Matrix2d::Identity();
  Eigen::Vector3d direction = (p - camera.centre()).normalized();
  if (splats.turn.cols() > 0) {
    const Eigen::Matrix3f turn = splats.turn.col(i).reshaped(3, 3);
    direction = turn.cast<double>().transpose() * direction;
  }
  double values[HarmonicCount(kMostHarmonicDegree)];
  Harmonics(splats.look->degree, direction, values);
  Eigen::Vector3d colour(0.5, 0.5, 0.5);
  const int count = HarmonicCount(splats.look->degree);
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < count; ++k) {
      colour[c] += values[k] * static_cast<double>(splats.look->harmonics(c * count + k, i));
    }
  }
  const double opacity = 1 / (1 + std::exp(-static_cast<double>(splats.look->logit[i])));
  return {t.z(),
          opacity,
          {camera.fx * t.x() / t.z() + camera.cx, camera.fy * t.y() / t.z() + camera.cy},
          s2.inverse(),
          colour.cwiseMax(0)};
}

// The colour at a pixel, and the part of it that splats cover.
std::pair<Eigen::Vector3d, double> Reference(const std::vector<Seen>& sorted,
                                             const Eigen::Vector2d& pixel,
                                             const Eigen::Vector3d& behind, double depth) {
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();
  double t = 1;
  for (const Seen& seen : sorted) {
    if (seen.depth <= 0.2 || seen.depth >= depth) continue;
    const Eigen::Vector2d d = pixel - seen.centre;
    const double alpha = std::min(0.99, seen.opacity * std::exp(-0.5 * d.dot(seen.inverse * d)));
    if (alpha < 1.0 / 255) continue;
    if (t * (1 - alpha) < 1e-4) break;
    colour += t * alpha * seen.colour;
    t *= 1 - alpha;
  }
  return {colour + t * behind, 1 - t};
}

void ExpectAsReference(const PlacedSplats& splats, const PinholeCamera& camera,
                       const Backdrop& backdrop) {
  std::vector<Seen> sorted;
  for (int i = 0; i < splats.look->count(); ++i) sorted.push_back(Look(splats, i, camera));
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Seen& a, const Seen& b) { return a.depth < b.depth; });
  const SplatPicture picture = Rasterise(splats, camera, backdrop, 2);
  double largest = 0, most_covered = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t place = static_cast<std::size_t>(y) * camera.width + x;
      Eigen::Vector3d behind = Eigen::Vector3d::Zero();
      double depth = 1e9;
      if (!backdrop.rgb.empty()) {
        behind = Eigen::Map<const Eigen::Vector3f>(&backdrop.rgb[3 * place]).cast<double>();
      }
      if (!backdrop.depth.empty()) depth = backdrop.depth[place];
      const auto [colour, covered] = Reference(sorted, {x + 0.5, y + 0.5}, behind, depth);
      const Eigen::Map<const Eigen::Vector3f> found(&picture.rgb[3 * place]);
      largest = std::max(largest, (found.cast<double>() - colour).cwiseAbs().maxCoeff());
      largest = std::max(largest, std::abs(picture.coverage[place] - covered));
      most_covered = std::max(most_covered, covered);
    }
  }
  EXPECT_LT(largest, 1e-4);
  EXPECT_GT(most_covered, 0.9);  // something is there
}

class RasteriseAtDegree : public ::testing::TestWithParam<int> {};

TEST_P(RasteriseAtDegree, IsThePublishedFormula) {
  const Splats splats = RandomSplats(400, GetParam(), 7);
  ExpectAsReference(AsStored(splats), Camera(90, 70), {});
}
INSTANTIATE_TEST_SUITE_P(OfEachDegree, RasteriseAtDegree, ::testing::Values(0, 1, 2, 3));

TEST(Rasterise, ABackdropIsBehindAndBetween) {
  const Splats splats = RandomSplats(400, 0, 8);
  const PinholeCamera camera = Camera(90, 70);
  Backdrop backdrop;
  for (int i = 0; i < 90 * 70; ++i) {
    const float shade = static_cast<float>(i % 7) / 7;
    backdrop.rgb.insert(backdrop.rgb.end(), {shade, 1 - shade, 0.5F});
    backdrop.depth.push_back(i % 90 < 40 ? 1.2F : 5.0F);
  }
  ExpectAsReference(AsStored(splats), camera, backdrop);
}

TEST(Rasterise, TurnedSplatsAreSeenFromTheirOwnSide) {
  const Splats splats = RandomSplats(300, 3, 9);
  PlacedSplats placed = AsStored(splats);
  placed.turn.resize(9, splats.count());
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(0.8F, Eigen::Vector3f(1, -0.5F, 0.3F).normalized()).matrix();
  for (int i = 0; i < splats.count(); ++i) placed.turn.col(i) = turn.reshaped();
  ExpectAsReference(placed, Camera(90, 70), {});
}

TEST(Rasterise, ThreadsDoNotChangeABit) {
  const Splats splats = RandomSplats(3000, 1, 10);
  const PlacedSplats placed = AsStored(splats);
  const PinholeCamera camera = Camera(200, 150);
  const SplatPicture one = Rasterise(placed, camera, {}, 1),
                     many = Rasterise(placed, camera, {}, 5);
  EXPECT_EQ(one.rgb, many.rgb);
  EXPECT_EQ(one.coverage, many.coverage);
}

TEST(Rasterise, NothingIsTheBackdrop) {
  Splats none = RandomSplats(0, 0, 1);
  const Backdrop backdrop{std::vector<float>(3 * 20 * 10, 0.25F), {}};
  const SplatPicture picture = Rasterise(AsStored(none), Camera(20, 10), backdrop, 1);
  EXPECT_EQ(picture.rgb, backdrop.rgb);
}

TEST(FastExp, IsTheExponentialTo1eMinus6) {
  for (double x = -6; x <= 0; x += 0.00137) {
    const double expected = std::exp(static_cast<double>(static_cast<float>(x)));
    EXPECT_NEAR(FastExp(static_cast<float>(x)), expected, 1e-6 * expected) << x;
  }
}

}  // namespace
}  // namespace physpring
