// SPDX-License-Identifier: Apache-2.0
#include "splats/rasterise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "splats/projection.h"
#include "splats/tile.h"
#include "splats/tile_bins.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

class Rasteriser {
 public:
  Rasteriser(const std::vector<Ellipse>& ellipses, const PinholeCamera& camera,
             const Backdrop& backdrop)
      : ellipses_(ellipses),
        camera_(camera),
        backdrop_(backdrop),
        bins_(camera.width, camera.height, BoxesOf(ellipses)) {}

  SplatPicture Draw(int threads) const {
    SplatPicture picture{camera_.width, camera_.height, {}, {}};
    const std::size_t pixels = static_cast<std::size_t>(camera_.width) * camera_.height;
    picture.rgb.resize(3 * pixels);
    picture.coverage.resize(pixels);
    ParallelFor(bins_.count(), threads, [&](int i) {
      Tile tile = Begin(i);
      Blend(ellipses_, bins_.In(i), &tile);
      Write(i, tile, &picture);
    });
    return picture;
  }

 private:
  static std::vector<EllipseBox> BoxesOf(const std::vector<Ellipse>& ellipses) {
    std::vector<EllipseBox> boxes;
    boxes.reserve(ellipses.size());
    for (const Ellipse& e : ellipses) boxes.push_back({e.u, e.v, e.half_width, e.half_height});
    return boxes;
  }

  // Calls use(pixel of the tile, pixel of the picture) for those that are in both.
  template <class Use>
  void ForEachPixel(int tile, const Use& use) const {
    const int left = bins_.left(tile), top = bins_.top(tile);
    const int width = std::min(kTile, camera_.width - left);
    const int height = std::min(kTile, camera_.height - top);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        use(kTile * y + x, static_cast<std::size_t>(top + y) * camera_.width + left + x);
      }
    }
  }

  Tile Begin(int i) const {
    Tile tile;
    tile.left = static_cast<float>(bins_.left(i));
    tile.top = static_cast<float>(bins_.top(i));
    ForEachPixel(i, [&](int pixel, std::size_t place) {  // T stays 0 beyond the picture
      tile.transmission[pixel] = 1;
      tile.depth[pixel] =
          backdrop_.depth.empty() ? std::numeric_limits<float>::infinity() : backdrop_.depth[place];
    });
    return tile;
  }

  void Write(int i, const Tile& tile, SplatPicture* picture) const {
    ForEachPixel(i, [&](int pixel, std::size_t place) {
      const float t = std::abs(tile.transmission[pixel]);
      picture->coverage[place] = 1 - t;
      float* rgb = &picture->rgb[3 * place];
      const float own[] = {tile.red[pixel], tile.green[pixel], tile.blue[pixel]};
      for (int colour = 0; colour < 3; ++colour) {
        const float behind = backdrop_.rgb.empty() ? 0 : backdrop_.rgb[3 * place + colour];
        rgb[colour] = own[colour] + t * behind;
      }
    });
  }

  const std::vector<Ellipse>& ellipses_;
  const PinholeCamera& camera_;
  const Backdrop& backdrop_;
  const TileBins bins_;
};

}  // namespace

SplatPicture Rasterise(const PlacedSplats& splats, const PinholeCamera& camera,
                       const Backdrop& backdrop, int threads) {
  const PlacedSplats* const group = &splats;
  return Rasterise({&group, 1}, camera, backdrop, threads);
}

SplatPicture Rasterise(SplatGroups groups, const PinholeCamera& camera, const Backdrop& backdrop,
                       int threads) {
  const std::vector<Ellipse> ellipses = Project(groups, camera, threads);
  return Rasteriser(ellipses, camera, backdrop).Draw(threads);
}

}  // namespace physpring
