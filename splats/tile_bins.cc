// SPDX-License-Identifier: Apache-2.0
#include "splats/tile_bins.h"

#include <algorithm>
#include <cmath>

#include "splats/tile.h"

namespace physpring {

TileBins::TileBins(int width, int height, std::span<const EllipseBox> boxes)
    : columns_((width + kTile - 1) / kTile), rows_((height + kTile - 1) / kTile) {
  const auto tile_of = [](float pixel, int most) {
    return std::clamp(static_cast<int>(std::floor(pixel / kTile)), 0, most);
  };
  const auto for_each_tile = [&](const EllipseBox& box, const auto& use) {
    const int end_column = tile_of(box.u + box.half_width, columns_ - 1) + 1;
    const int end_row = tile_of(box.v + box.half_height, rows_ - 1) + 1;
    for (int row = tile_of(box.v - box.half_height, rows_); row < end_row; ++row) {
      for (int column = tile_of(box.u - box.half_width, columns_); column < end_column; ++column) {
        use(static_cast<std::size_t>(row) * columns_ + column);
      }
    }
  };
  begin_.assign(static_cast<std::size_t>(count()) + 1, 0);
  for (const EllipseBox& box : boxes) {
    for_each_tile(box, [this](std::size_t tile) { ++begin_[tile + 1]; });
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  box_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for_each_tile(boxes[i],
                  [&](std::size_t tile) { box_[next[tile]++] = static_cast<std::uint32_t>(i); });
  }
}

int TileBins::left(int tile) const { return tile % columns_ * kTile; }

int TileBins::top(int tile) const { return tile / columns_ * kTile; }

std::span<const std::uint32_t> TileBins::In(int tile) const {
  return std::span(box_).subspan(begin_[tile], begin_[tile + 1] - begin_[tile]);
}

}  // namespace physpring
