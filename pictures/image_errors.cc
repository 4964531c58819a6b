// SPDX-License-Identifier: Apache-2.0
#include "pictures/image_errors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace physpring {
namespace {

constexpr int kChannels = 3, kReach = 5, kWindow = 2 * kReach + 1;  // pixels
constexpr double kByte = 255;

std::array<double, kWindow> WindowWeights() {
  constexpr double kDeviation = 1.5;
  std::array<double, kWindow> weights;
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) {
    const double d = (i - kReach) / kDeviation;
    sum += weights[i] = std::exp(-0.5 * d * d);
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::size_t Place(const Image& image, int x, int y) {
  return kChannels * (static_cast<std::size_t>(y) * image.width + x);
}

PixelBox Common(const PixelBox& a, const PixelBox& b) {
  return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right),
          std::min(a.bottom, b.bottom)};
}

PixelBox Grown(const PixelBox& box, int by) {
  return {box.left - by, box.top - by, box.right + by, box.bottom + by};
}

// Weighted means about each pixel of a box: of the two pictures, their squares, their product.
struct Moments {
  double one = 0, other = 0, one_one = 0, other_other = 0, one_other = 0;

  void Add(double weight, const Moments& m) {
    one += weight * m.one;
    other += weight * m.other;
    one_one += weight * m.one_one;
    other_other += weight * m.other_other;
    one_other += weight * m.one_other;
  }

  double Similarity() const {
    constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
    const double covariance = one_other - one * other;
    const double variances = one_one - one * one + other_other - other * other;
    return (2 * one * other + kC1) * (2 * covariance + kC2) /
           ((one * one + other * other + kC1) * (variances + kC2));
  }
};

// The sum of similarities over the box, in one channel.
double SumOfSimilarities(const Image& one, const Image& other, int channel, const PixelBox& box) {
  static const std::array<double, kWindow> weights = WindowWeights();
  const int width = box.right - box.left;
  const PixelBox rows =
      Common(Grown(box, kReach), {box.left - kReach, 0, box.right + kReach, one.height});
  // along rows, for all rows that reach into the box
  std::vector<Moments> along(static_cast<std::size_t>(rows.bottom - rows.top) * width);
  for (int y = rows.top; y < rows.bottom; ++y) {
    for (int x = box.left; x < box.right; ++x) {
      Moments& sum = along[static_cast<std::size_t>(y - rows.top) * width + x - box.left];
      for (int i = 0; i < kWindow; ++i) {
        const int from = x + i - kReach;
        if (from < 0 || from >= one.width) continue;
        const std::size_t at = Place(one, from, y) + channel;
        const double a = one.rgb[at] / kByte, b = other.rgb[at] / kByte;
        sum.Add(weights[i], {a, b, a * a, b * b, a * b});
      }
    }
  }
  double total = 0;
  for (int y = box.top; y < box.bottom; ++y) {
    for (int x = 0; x < width; ++x) {
      Moments sum;
      for (int i = 0; i < kWindow; ++i) {
        const int from = y + i - kReach;
        if (from < rows.top || from >= rows.bottom) continue;
        sum.Add(weights[i], along[static_cast<std::size_t>(from - rows.top) * width + x]);
      }
      total += sum.Similarity();
    }
  }
  return total;
}

double PixelsIn(const PixelBox& box) {
  return static_cast<double>(box.right - box.left) * (box.bottom - box.top);
}

template <class Keep>
Image Only(const Image& image, const Mask& mask, const Keep& keep) {
  Image result{image.width, image.height, std::vector<unsigned char>(image.rgb.size(), 0)};
  for (std::size_t i = 0; i < mask.kind.size(); ++i) {
    if (keep(mask.kind[i])) {
      std::copy_n(&image.rgb[kChannels * i], kChannels, &result.rgb[kChannels * i]);
    }
  }
  return result;
}

double Iou(const std::vector<float>& coverage, const Mask& mask) {
  constexpr float kHalf = 0.5F;
  std::size_t both = 0, either = 0;
  for (std::size_t i = 0; i < mask.kind.size(); ++i) {
    const bool recorded = mask.kind[i] == kObject;
    const bool predicted = coverage[i] >= kHalf && mask.kind[i] != kHidden;
    both += recorded && predicted ? 1 : 0;
    either += recorded || predicted ? 1 : 0;
  }
  return static_cast<double>(both) / static_cast<double>(either);
}

}  // namespace

PixelBox BoxNotBlack(const Image& one, const Image& other) {
  PixelBox box{one.width, one.height, 0, 0};
  for (int y = 0; y < one.height; ++y) {
    for (int x = 0; x < one.width; ++x) {
      const std::size_t at = Place(one, x, y);
      const auto is_black = [at](const Image& image) {
        return image.rgb[at] == 0 && image.rgb[at + 1] == 0 && image.rgb[at + 2] == 0;
      };
      if (is_black(one) && is_black(other)) continue;
      box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x + 1),
             std::max(box.bottom, y + 1)};
    }
  }
  return box;
}

double Psnr(const Image& one, const Image& other, const PixelBox& box) {
  double sum = 0;
  for (int y = box.top; y < box.bottom; ++y) {
    for (std::size_t at = Place(one, box.left, y); at < Place(one, box.right, y); ++at) {
      const double d = (one.rgb[at] - other.rgb[at]) / kByte;
      sum += d * d;
    }
  }
  const double mean = sum / (kChannels * PixelsIn(box));
  return mean > 0 ? std::min(kMostPsnr, -10 * std::log10(mean)) : kMostPsnr;
}

double Ssim(const Image& one, const Image& other, const PixelBox& box) {
  // where both are black all around, the similarity is 1
  const PixelBox work = Common(box, Grown(BoxNotBlack(one, other), kReach));
  if (work.empty()) return 1;
  double sum = kChannels * (PixelsIn(box) - PixelsIn(work));
  for (int channel = 0; channel < kChannels; ++channel) {
    sum += SumOfSimilarities(one, other, channel, work);
  }
  return sum / (kChannels * PixelsIn(box));
}

Image ObjectAlone(const Image& image, const Mask& mask) {
  return Only(image, mask, [](unsigned char kind) { return kind == kObject; });
}

Image WithoutHidden(const Image& image, const Mask& mask) {
  return Only(image, mask, [](unsigned char kind) { return kind != kHidden; });
}

PixelBox BoxOf(const Mask& mask) {
  PixelBox box{mask.width, mask.height, 0, 0};
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (mask.kind[static_cast<std::size_t>(y) * mask.width + x] != kObject) continue;
      box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x + 1),
             std::max(box.bottom, y + 1)};
    }
  }
  return box;
}

std::optional<ImageErrors> CompareImages(const Image& predicted, const std::vector<float>& coverage,
                                         const Image& recorded, const Mask& mask) {
  const PixelBox box = BoxOf(mask);
  if (box.empty()) return std::nullopt;
  const Image one = WithoutHidden(predicted, mask), other = ObjectAlone(recorded, mask);
  const PixelBox whole{0, 0, recorded.width, recorded.height};
  return ImageErrors{Iou(coverage, mask), Psnr(one, other, whole), Ssim(one, other, whole),
                     Psnr(one, other, box), Ssim(one, other, box)};
}

}  // namespace physpring
