// SPDX-License-Identifier: Apache-2.0
// Which ellipses reach into which tile of a picture.
#ifndef PHYSPRING_SPLATS_TILE_BINS_H_
#define PHYSPRING_SPLATS_TILE_BINS_H_

#include <cstdint>
#include <span>
#include <vector>

namespace physpring {

// About an ellipse, in pixels.
struct EllipseBox {
  float u = 0, v = 0;                     // its centre
  float half_width = 0, half_height = 0;  // from there
};

class TileBins {
 public:
  // Tiles of kTile x kTile pixels over a picture.
  TileBins(int width, int height, std::span<const EllipseBox> boxes);

  int count() const { return columns_ * rows_; }
  int left(int tile) const;  // pixels
  int top(int tile) const;
  // The numbers of the boxes that touch the tile, increasing.
  std::span<const std::uint32_t> In(int tile) const;
  // Where they begin in a list of those of all tiles, and how long that is.
  std::size_t First(int tile) const { return begin_[tile]; }
  std::size_t size() const { return box_.size(); }

 private:
  int columns_, rows_;
  std::vector<std::uint32_t> begin_, box_;  // those of tile i are at [begin[i], begin[i + 1])
};

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_TILE_BINS_H_
