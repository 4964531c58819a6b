// SPDX-License-Identifier: Apache-2.0
// The work of the rasteriser on one tile: ellipses over 16 x 16 pixels, the nearest first. It is
// compiled for several instruction sets; all give the same bits.
#ifndef PHYSPRING_SPLATS_TILE_H_
#define PHYSPRING_SPLATS_TILE_H_

#include <array>
#include <cstdint>
#include <span>

#include "splats/projection.h"

namespace physpring {

constexpr int kTile = 16;  // pixels
constexpr float kLeastTransmission = 1e-4F;

struct Tile {
  template <class Number>
  using Pixels = std::array<Number, kTile * kTile>;  // row by row

  float left = 0, top = 0;  // pixels, of its first pixel's corner
  alignas(64) Pixels<float> red{}, green{}, blue{};
  alignas(64) Pixels<float> transmission{};  // T; less than 0: T was that when it ended
  alignas(64) Pixels<float> depth{};         // of the backdrop, m
};

// Adds the ellipses of these numbers, in this order, until nothing more is seen.
void Blend(std::span<const Ellipse> ellipses, std::span<const std::uint32_t> order, Tile* tile);

// exp(x) for -80 <= x <= 0 to 1e-6 of it, by operations that are the same on every processor.
float FastExp(float x);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_TILE_H_
