// SPDX-License-Identifier: Apache-2.0
#include "splats/tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace physpring {
namespace {

// 8 pixels of a row at once. (16 are one register of AVX-512, but for processors without it g++
// takes choices between larger vectors apart into single numbers.)
constexpr int kLanes = 8;
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));

// exp(x) = 2^n 2^f, n whole, |f| <= 1/2; 2^f by its series to the sixth power.
__attribute__((always_inline)) inline Floats Exp(Floats x) {
  const Floats y = x * 1.44269504088896341F;
  const Floats shifter = Floats{} + 12582912.0F;  // 1.5 * 2^23: rounds to whole numbers
  const Floats whole = (y + shifter) - shifter;
  const Floats f = y - whole;
  Floats power = Floats{} + 1.5403530393381608e-4F;
  power = power * f + 1.3333558146428443e-3F;
  power = power * f + 9.6181291076284772e-3F;
  power = power * f + 5.5504108664821580e-2F;
  power = power * f + 2.4022650695910072e-1F;
  power = power * f + 6.9314718055994531e-1F;
  power = power * f + 1.0F;
  const Ints exponent = (__builtin_convertvector(whole, Ints) + 127) << 23;
  return power * std::bit_cast<Floats>(exponent);
}

__attribute__((always_inline)) inline Floats Load(const float* from) {
  Floats values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

__attribute__((always_inline)) inline void Store(const Floats& values, float* to) {
  std::memcpy(to, &values, sizeof values);
}

__attribute__((always_inline)) inline Floats Columns() {
  Floats columns;
  for (int i = 0; i < kLanes; ++i) columns[i] = static_cast<float>(i) + 0.5F;
  return columns;
}

// Adds the ellipse to a part of a row, from pixel `at` on. Where no more light comes through, T is
// kept as -T.
__attribute__((always_inline)) inline void BlendRow(const Ellipse& e, const Floats& dx, float dy,
                                                    int at, Tile* tile) {
  const Floats t = Load(&tile->transmission[at]);
  const Floats q = 0.5F * (e.a * dx * dx + e.c * dy * dy) + e.b * dy * dx;
  Floats alpha = e.opacity * Exp(-(q < e.cutoff ? q : Floats{} + e.cutoff));
  alpha = alpha < kMostOpaque ? alpha : Floats{} + kMostOpaque;
  const Floats after = t * (1.0F - alpha);
  const Ints seen = (q < e.cutoff) & (q >= 0.0F) & (alpha >= kFaintest) &
                    (Load(&tile->depth[at]) > e.depth) & (t >= kLeastTransmission);
  const Ints ends = seen & (after < kLeastTransmission);
  const Ints adds = seen & ~ends;
  const Floats weight = adds ? t * alpha : Floats{};
  Store(Load(&tile->red[at]) + weight * e.red, &tile->red[at]);
  Store(Load(&tile->green[at]) + weight * e.green, &tile->green[at]);
  Store(Load(&tile->blue[at]) + weight * e.blue, &tile->blue[at]);
  Store(ends ? -t : (adds ? after : t), &tile->transmission[at]);
}

// The rows of a tile whose centres are within `half` of `v`.
struct Rows {
  int first, end;
  Rows(float v, float half)
      : first(std::clamp(static_cast<int>(std::ceil(v - half - 0.5F)), 0, kTile)),
        end(std::clamp(static_cast<int>(std::floor(v + half - 0.5F)) + 1, 0, kTile)) {}
};

bool IsDark(const Tile& tile) {
  const float most = *std::max_element(tile.transmission.begin(), tile.transmission.end());
  return most < kLeastTransmission;
}

}  // namespace

__attribute__((target_clones("avx512f", "avx2", "default"))) void Blend(
    std::span<const Ellipse> ellipses, std::span<const std::uint32_t> order, Tile* tile) {
  constexpr std::size_t kBetweenLooks = 16;  // ellipses
  const Floats columns = Columns();
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % kBetweenLooks == kBetweenLooks - 1 && IsDark(*tile)) return;
    const Ellipse& e = ellipses[order[i]];
    const Rows rows(e.v - tile->top, e.half_height);
    for (int row = rows.first; row < rows.end; ++row) {
      const float dy = static_cast<float>(row) + 0.5F - (e.v - tile->top);
      for (int part = 0; part < kTile; part += kLanes) {
        const Floats dx = columns - (e.u - tile->left - static_cast<float>(part));
        BlendRow(e, dx, dy, kTile * row + part, tile);
      }
    }
  }
}

float FastExp(float x) {
  const Floats y = Exp(Floats{} + x);
  return y[0];
}

}  // namespace physpring
