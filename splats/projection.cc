// SPDX-License-Identifier: Apache-2.0
#include "splats/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "splats/harmonics.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

using Matrix = Eigen::Matrix3f;
using Vector = Eigen::Vector3f;

constexpr int kBlock = 4096;  // splats that a thread takes at once

class Projector {
 public:
  Projector(const PlacedSplats& splats, const PinholeCamera& camera)
      : splats_(splats),
        camera_(camera),
        axes_(camera.axes.cast<float>()),
        shift_(camera.shift.cast<float>()),
        centre_(camera.centre().cast<float>()),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)) {}

  // Adds what is seen of splats `first` to `end`.
  void Add(int first, int end, std::vector<Ellipse>* seen) const {
    for (int i = first; i < end; ++i) {
      Ellipse ellipse;
      if (!Place(i, &ellipse)) continue;
      Colour(i, &ellipse);
      seen->push_back(ellipse);
    }
  }

 private:
  bool Place(int i, Ellipse* ellipse) const {
    const Vector t = axes_ * splats_.position.col(i) + shift_;
    if (!(t.z() > kNearest)) return false;
    ellipse->depth = t.z();
    ellipse->opacity = 1 / (1 + std::exp(-splats_.look->logit[i]));
    if (!(ellipse->opacity >= kFaintest)) return false;
    ellipse->cutoff = std::log(255 * ellipse->opacity);
    ellipse->u = fx_ * t.x() / t.z() + static_cast<float>(camera_.cx);
    ellipse->v = fy_ * t.y() / t.z() + static_cast<float>(camera_.cy);
    return Shape(i, t, ellipse) && IsSeen(*ellipse);
  }

  // The derivative of (u, v) at t.
  Eigen::Matrix<float, 2, 3> Derivative(const Vector& t) const {
    const auto within = [](float x, double from, double to) {
      return std::clamp(x, static_cast<float>(from), static_cast<float>(to));
    };
    const float x = within(t.x() / t.z(), -kBeyond * camera_.cx / camera_.fx,
                           kBeyond * (camera_.width - camera_.cx) / camera_.fx);
    const float y = within(t.y() / t.z(), -kBeyond * camera_.cy / camera_.fy,
                           kBeyond * (camera_.height - camera_.cy) / camera_.fy);
    Eigen::Matrix<float, 2, 3> derivative;
    derivative << fx_ / t.z(), 0, -fx_ * x / t.z(), 0, fy_ / t.z(), -fy_ * y / t.z();
    return derivative;
  }

  bool Shape(int i, const Vector& t, Ellipse* ellipse) const {
    const Eigen::Matrix<float, 2, 3> m = Derivative(t) * axes_;
    const Eigen::Matrix<float, 2, 3> mc = m * splats_.Covariance(i);
    const float xx = mc.row(0).dot(m.row(0)) + kBlur, yy = mc.row(1).dot(m.row(1)) + kBlur;
    const float xy = mc.row(0).dot(m.row(1));
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0)) return false;
    ellipse->a = yy / determinant;
    ellipse->b = -xy / determinant;
    ellipse->c = xx / determinant;
    ellipse->half_width = std::sqrt(2 * ellipse->cutoff * xx);
    ellipse->half_height = std::sqrt(2 * ellipse->cutoff * yy);
    return true;
  }

  bool IsSeen(const Ellipse& e) const {
    return e.u + e.half_width > 0 && e.u - e.half_width < static_cast<float>(camera_.width) &&
           e.v + e.half_height > 0 && e.v - e.half_height < static_cast<float>(camera_.height);
  }

  void Colour(int i, Ellipse* ellipse) const {
    const Splats& look = *splats_.look;
    Vector direction = (splats_.position.col(i) - centre_).normalized();
    if (splats_.turn.cols() > 0) {
      direction = Eigen::Map<const Matrix>(splats_.turn.col(i).data()).transpose() * direction;
    }
    std::array<float, HarmonicCount(kMostHarmonicDegree)> values;
    Harmonics(look.degree, direction, values.data());
    const int count = HarmonicCount(look.degree);
    const float* weights = look.harmonics.col(i).data();
    const auto channel = [&](int colour) {
      float sum = 0.5F;
      for (int k = 0; k < count; ++k) sum += weights[colour * count + k] * values[k];
      return std::max(sum, 0.0F);
    };
    ellipse->red = channel(0);
    ellipse->green = channel(1);
    ellipse->blue = channel(2);
  }

  const PlacedSplats& splats_;
  const PinholeCamera& camera_;
  Matrix axes_;
  Vector shift_, centre_;
  float fx_, fy_;
};

// By depth, which is positive, so that its bits are in its order: three passes of 11 bits.
void SortByDepth(std::vector<Ellipse>* ellipses) {
  const std::size_t count = ellipses->size();
  struct Key {
    std::uint32_t depth, index;
  };
  std::vector<Key> keys(count), sorted(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&keys[i].depth, &(*ellipses)[i].depth, sizeof(float));
    keys[i].index = static_cast<std::uint32_t>(i);
  }
  constexpr int kBits = 11;
  for (int shift = 0; shift < 32; shift += kBits) {
    std::array<std::size_t, (1 << kBits) + 1> place{};
    const auto digit = [&](const Key& key) { return (key.depth >> shift) & ((1U << kBits) - 1); };
    for (const Key& key : keys) ++place[digit(key) + 1];
    for (std::size_t d = 1; d < place.size(); ++d) place[d] += place[d - 1];
    for (const Key& key : keys) sorted[place[digit(key)]++] = key;
    keys.swap(sorted);
  }
  std::vector<Ellipse> in_order(count);
  for (std::size_t i = 0; i < count; ++i) in_order[i] = (*ellipses)[keys[i].index];
  ellipses->swap(in_order);
}

}  // namespace

std::vector<Ellipse> Project(SplatGroups groups, const PinholeCamera& camera, int threads) {
  std::vector<Ellipse> all;
  for (const PlacedSplats* splats : groups) {
    const Projector projector(*splats, camera);
    const int count = static_cast<int>(splats->position.cols());
    const int blocks = (count + kBlock - 1) / kBlock;
    std::vector<std::vector<Ellipse>> seen(static_cast<std::size_t>(blocks));
    ParallelFor(blocks, threads, [&](int block) {
      projector.Add(block * kBlock, std::min(count, (block + 1) * kBlock), &seen[block]);
    });
    for (const auto& part : seen) all.insert(all.end(), part.begin(), part.end());
  }
  SortByDepth(&all);
  return all;
}

}  // namespace physpring
