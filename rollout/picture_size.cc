// SPDX-License-Identifier: Apache-2.0
#include "rollout/picture_size.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace physpring {
namespace {

constexpr int kColours = 3;
constexpr int kBits = 22;  // of a weight behind the point, as in Pillow's Resample.c

// What one pixel of a row is made of: pixels from `first` on, times `weights`, which add up to 1.
struct Tap {
  int first;
  std::vector<int> weights;  // in units of 2^-kBits
};

// The triangle filter from `from` pixels to `to`.
std::vector<Tap> Taps(int from, int to) {
  const double scale = static_cast<double>(from) / to;
  const double stretch = std::max(scale, 1.0);  // of the filter, whose support is 1
  std::vector<Tap> taps;
  for (int pixel = 0; pixel < to; ++pixel) {
    const double centre = (pixel + 0.5) * scale;
    const int first = std::max(0, static_cast<int>(std::floor(centre - stretch + 0.5)));
    const int end = std::min(from, static_cast<int>(std::floor(centre + stretch + 0.5)));
    std::vector<double> weights;
    double sum = 0;
    for (int i = first; i < end; ++i) {
      weights.push_back(std::max(0.0, 1 - std::abs((i - centre + 0.5) / stretch)));
      sum += weights.back();
    }
    Tap tap{first, {}};
    for (const double weight : weights) {
      tap.weights.push_back(static_cast<int>(std::floor(0.5 + weight / sum * (1 << kBits))));
    }
    taps.push_back(std::move(tap));
  }
  return taps;
}

// Sums of bytes that are `stride` apart.
unsigned char Sum(const unsigned char* bytes, std::size_t stride, const Tap& tap) {
  int sum = 1 << (kBits - 1);
  for (std::size_t i = 0; i < tap.weights.size(); ++i) sum += tap.weights[i] * bytes[i * stride];
  return static_cast<unsigned char>(std::clamp(sum >> kBits, 0, 255));
}

Image ResizeRows(const Image& image, int width) {
  if (image.width == width) return image;
  Image resized{width, image.height, {}};
  const std::vector<Tap> taps = Taps(image.width, width);
  for (int row = 0; row < image.height; ++row) {
    const unsigned char* line = image.rgb.data() + std::size_t{kColours} * row * image.width;
    for (const Tap& tap : taps) {
      for (int colour = 0; colour < kColours; ++colour) {
        resized.rgb.push_back(Sum(line + kColours * tap.first + colour, kColours, tap));
      }
    }
  }
  return resized;
}

Image ResizeColumns(const Image& image, int height) {
  if (image.height == height) return image;
  Image resized{image.width, height, {}};
  const std::size_t line = std::size_t{kColours} * image.width;  // bytes
  for (const Tap& tap : Taps(image.height, height)) {
    const unsigned char* top = image.rgb.data() + line * tap.first;
    for (std::size_t byte = 0; byte < line; ++byte) {
      resized.rgb.push_back(Sum(top + byte, line, tap));
    }
  }
  return resized;
}

}  // namespace

Image ResizeWithPad(const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  const double ratio = std::max(static_cast<double>(image.width) / width,
                                static_cast<double>(image.height) / height);
  const int inner_width = std::max(1, static_cast<int>(image.width / ratio));
  const int inner_height = std::max(1, static_cast<int>(image.height / ratio));
  const Image inner = ResizeColumns(ResizeRows(image, inner_width), inner_height);
  Image padded{width, height, {}};
  padded.rgb.resize(std::size_t{kColours} * width * height, 0);
  const int left = (width - inner_width) / 2, top = (height - inner_height) / 2;
  for (int row = 0; row < inner_height; ++row) {
    const auto line = inner.rgb.begin() + std::ptrdiff_t{kColours} * row * inner_width;
    std::copy_n(line, std::ptrdiff_t{kColours} * inner_width,
                padded.rgb.begin() + std::ptrdiff_t{kColours} * ((top + row) * width + left));
  }
  return padded;
}

Image Mirror(const Image& image) {
  Image mirrored = image;
  for (int row = 0; row < image.height; ++row) {
    const std::size_t line = std::size_t{kColours} * row * image.width;
    for (int column = 0; column < image.width; ++column) {
      const std::size_t other = line + std::size_t{kColours} * (image.width - 1 - column);
      std::copy_n(image.rgb.begin() + static_cast<std::ptrdiff_t>(other), kColours,
                  mirrored.rgb.begin() + static_cast<std::ptrdiff_t>(line + kColours * column));
    }
  }
  return mirrored;
}

}  // namespace physpring
