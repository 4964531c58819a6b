// SPDX-License-Identifier: Apache-2.0
#include "splats/fit/picture_loss.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "splats/fit/free_ellipse.h"
#include "splats/in_parallel.h"
#include "splats/projection.h"
#include "splats/tile.h"
#include "splats/tile_bins.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

// What the camera sees, the nearest first.
std::vector<FreeEllipse> ProjectAll(const FreeSplats& splats, const PinholeCamera& camera,
                                    int threads) {
  const int count = static_cast<int>(splats.cols());
  std::vector<FreeEllipse> all(static_cast<std::size_t>(count));
  std::vector<char> seen(static_cast<std::size_t>(count));
  InParallel(count, threads, [&](int i) {
    all[i].splat = i;
    seen[i] = ProjectFree(splats.col(i), camera, &all[i]) ? 1 : 0;
  });
  std::vector<FreeEllipse> sorted;
  for (int i = 0; i < count; ++i) {
    if (seen[i] != 0) sorted.push_back(all[i]);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const FreeEllipse& a, const FreeEllipse& b) { return a.depth < b.depth; });
  return sorted;
}

// An ellipse that adds to a pixel's colour.
struct Layer {
  std::size_t ellipse;            // in the tile's list
  double dx, dy, falloff, alpha;  // falloff: exp(-q)
  double before;                  // T in front of it
};

// One pixel, forwards and back.
class PixelWalk {
 public:
  PixelWalk(const std::vector<FreeEllipse>& ellipses, std::span<const std::uint32_t> order)
      : ellipses_(ellipses), order_(order) {}

  Pixel Forward(double x, double y) {
    layers_.clear();
    Pixel pixel;
    double t = 1;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const FreeEllipse& e = ellipses_[order_[i]];
      const double dx = x - e.u, dy = y - e.v;
      const double q = 0.5 * (e.a * dx * dx + e.c * dy * dy) + e.b * dx * dy;
      if (!(q < e.cutoff && q >= 0)) continue;
      const double falloff = std::exp(-q);
      const double alpha = std::min<double>(kMostOpaque, e.opacity * falloff);
      if (alpha < kFaintest) continue;
      if (t * (1 - alpha) < kLeastTransmission) break;
      layers_.push_back({i, dx, dy, falloff, alpha, t});
      pixel.colour += t * alpha * e.colour;
      t *= 1 - alpha;
    }
    pixel.coverage = 1 - t;
    return pixel;
  }

  // Adds to the derivatives with respect to the ellipses of the tile's list.
  void Backward(const Pixel& pixel, const Pixel& bar, EllipseNumbers* bars) const {
    const double left = 1 - pixel.coverage;  // T behind all
    double behind = 0;                       // sum over what is behind of T alpha c . bar
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      const FreeEllipse& e = ellipses_[order_[layer->ellipse]];
      EllipseNumbers& to = bars[layer->ellipse];
      const double along = e.colour.dot(bar.colour);
      to.colour += layer->before * layer->alpha * bar.colour;
      const double alpha_bar =
          layer->before * along + (left * bar.coverage - behind) / (1 - layer->alpha);
      behind += layer->before * layer->alpha * along;
      if (e.opacity * layer->falloff >= kMostOpaque) continue;
      to.opacity += layer->falloff * alpha_bar;
      const double q_bar = -layer->alpha * alpha_bar;
      const double dx = layer->dx, dy = layer->dy;
      to.a += 0.5 * dx * dx * q_bar;
      to.b += dx * dy * q_bar;
      to.c += 0.5 * dy * dy * q_bar;
      to.u -= (e.a * dx + e.b * dy) * q_bar;
      to.v -= (e.c * dy + e.b * dx) * q_bar;
    }
  }

 private:
  const std::vector<FreeEllipse>& ellipses_;
  std::span<const std::uint32_t> order_;
  std::vector<Layer> layers_;
};

}  // namespace

double AddPictureLoss(const FreeSplats& splats, const PinholeCamera& camera, const PixelLoss& loss,
                      int threads, FreeSplats* gradient) {
  const std::vector<FreeEllipse> ellipses = ProjectAll(splats, camera, threads);
  std::vector<EllipseBox> boxes;
  for (const FreeEllipse& e : ellipses) boxes.push_back(e.box);
  const TileBins bins(camera.width, camera.height, boxes);

  std::vector<double> sums(static_cast<std::size_t>(bins.count()), 0);
  std::vector<EllipseNumbers> parts(bins.size());  // of each ellipse in each tile
  ParallelFor(bins.count(), threads, [&](int tile) {
    PixelWalk walk(ellipses, bins.In(tile));
    const int right = std::min(camera.width, bins.left(tile) + kTile);
    const int bottom = std::min(camera.height, bins.top(tile) + kTile);
    for (int y = bins.top(tile); y < bottom; ++y) {
      for (int x = bins.left(tile); x < right; ++x) {
        const Pixel pixel = walk.Forward(x + 0.5, y + 0.5);
        Pixel bar;
        sums[tile] += loss(static_cast<std::size_t>(y) * camera.width + x, pixel, &bar);
        walk.Backward(pixel, bar, parts.data() + bins.First(tile));
      }
    }
  });

  std::vector<EllipseNumbers> bars(ellipses.size());
  for (int tile = 0; tile < bins.count(); ++tile) {
    std::size_t part = bins.First(tile);
    for (const std::uint32_t ellipse : bins.In(tile)) bars[ellipse] += parts[part++];
  }
  const int count = static_cast<int>(ellipses.size());
  InParallel(count, threads, [&](int i) {
    const int splat = ellipses[i].splat;
    ProjectFreeAdjoint(splats.col(splat), camera, bars[i], gradient->col(splat));
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace physpring
