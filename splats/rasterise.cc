// SPDX-License-Identifier: Apache-2.0
#include "splats/rasterise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "splats/projection.h"
#include "splats/tile.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

// Which ellipses reach into which tile, the nearest first: those of tile i are at
// [begin[i], begin[i + 1]).
struct Bins {
  std::vector<std::uint32_t> begin, ellipse;
};

// The tiles that the box of an ellipse touches.
struct Range {
  int first_column, end_column, first_row, end_row;
};

class Rasteriser {
 public:
  Rasteriser(const PinholeCamera& camera, const Backdrop& backdrop, int threads)
      : camera_(camera),
        backdrop_(backdrop),
        threads_(threads),
        columns_((camera.width + kTile - 1) / kTile),
        rows_((camera.height + kTile - 1) / kTile) {}

  SplatPicture Draw(const std::vector<Ellipse>& ellipses) const {
    const Bins bins = Sort(ellipses);
    SplatPicture picture{camera_.width, camera_.height, {}, {}};
    const std::size_t pixels = static_cast<std::size_t>(camera_.width) * camera_.height;
    picture.rgb.resize(3 * pixels);
    picture.coverage.resize(pixels);
    ParallelFor(columns_ * rows_, threads_, [&](int i) {
      Tile tile = Begin(i);
      const std::uint32_t from = bins.begin[i], to = bins.begin[i + 1];
      Blend(ellipses, std::span(bins.ellipse).subspan(from, to - from), &tile);
      Write(i, tile, &picture);
    });
    return picture;
  }

 private:
  Range TilesOf(const Ellipse& e) const {
    const auto tile = [](float pixel, int most) {
      return std::clamp(static_cast<int>(std::floor(pixel / kTile)), 0, most);
    };
    return {tile(e.u - e.half_width, columns_), tile(e.u + e.half_width, columns_ - 1) + 1,
            tile(e.v - e.half_height, rows_), tile(e.v + e.half_height, rows_ - 1) + 1};
  }

  template <class Use>
  void ForEachTile(const Ellipse& e, const Use& use) const {
    const Range range = TilesOf(e);
    for (int row = range.first_row; row < range.end_row; ++row) {
      for (int column = range.first_column; column < range.end_column; ++column) {
        use(static_cast<std::size_t>(row) * columns_ + column);
      }
    }
  }

  Bins Sort(const std::vector<Ellipse>& ellipses) const {
    Bins bins;
    bins.begin.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (const Ellipse& e : ellipses) {
      ForEachTile(e, [&](std::size_t tile) { ++bins.begin[tile + 1]; });
    }
    for (std::size_t i = 1; i < bins.begin.size(); ++i) bins.begin[i] += bins.begin[i - 1];
    bins.ellipse.resize(bins.begin.back());
    std::vector<std::uint32_t> next(bins.begin.begin(), bins.begin.end() - 1);
    for (std::size_t i = 0; i < ellipses.size(); ++i) {
      ForEachTile(ellipses[i], [&](std::size_t tile) {
        bins.ellipse[next[tile]++] = static_cast<std::uint32_t>(i);
      });
    }
    return bins;
  }

  // Calls use(pixel of the tile, pixel of the picture) for those that are in both.
  template <class Use>
  void ForEachPixel(int tile, const Use& use) const {
    const int left = tile % columns_ * kTile, top = tile / columns_ * kTile;
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
    tile.left = static_cast<float>(i % columns_ * kTile);
    const int row = i / columns_;
    tile.top = static_cast<float>(row * kTile);
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

  const PinholeCamera& camera_;
  const Backdrop& backdrop_;
  int threads_, columns_, rows_;
};

}  // namespace

SplatPicture Rasterise(const PlacedSplats& splats, const PinholeCamera& camera,
                       const Backdrop& backdrop, int threads) {
  const std::vector<Ellipse> ellipses = Project(splats, camera, threads);
  return Rasteriser(camera, backdrop, threads).Draw(ellipses);
}

}  // namespace physpring
