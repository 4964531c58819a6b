// SPDX-License-Identifier: Apache-2.0
#include "splats/splat_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "splats/ply_header.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;
constexpr float kFarthest = 1e6F, kMostLogScale = 20, kMostLogit = 1e4F, kMostColour = 1e4F;

int DegreeOf(const std::string& path, const PlyHeader& header) {
  int rest = 0;
  while (header.floats.contains(fmt::format("f_rest_{}", rest))) ++rest;
  for (int degree = 0; degree <= kMostHarmonicDegree; ++degree) {
    if (rest == 3 * (HarmonicCount(degree) - 1)) return degree;
  }
  FailPly(path, fmt::format("has {} properties f_rest_*, expected 0, 9, 24 or 45", rest));
}

// Where the numbers of a splat are in a row, in the order of the members of Splats.
std::vector<std::size_t> PlacesOf(const std::string& path, const PlyHeader& header, int degree) {
  std::vector<std::string> names = {"x",     "y",     "z",     "scale_0", "scale_1", "scale_2",
                                    "rot_0", "rot_1", "rot_2", "rot_3",   "opacity"};
  const int rest = HarmonicCount(degree) - 1;
  for (int colour = 0; colour < 3; ++colour) {
    names.push_back(fmt::format("f_dc_{}", colour));
    for (int k = 0; k < rest; ++k) names.push_back(fmt::format("f_rest_{}", colour * rest + k));
  }
  std::vector<std::size_t> places;
  for (const std::string& name : names) places.push_back(FloatAt(header, path, name));
  return places;
}

void Put(const std::vector<float>& numbers, int i, Splats* splats) {
  const float* next = numbers.data();
  const auto take = [&next](auto column) {
    for (float& x : column) x = *next++;
  };
  take(splats->position.col(i));
  take(splats->log_scale.col(i));
  take(splats->rotation.col(i));
  splats->logit[i] = *next++;
  take(splats->harmonics.col(i));
}

// Some programs write flat splats and full opacities as infinities.
void Bound(int i, Splats* splats) {
  for (float& scale : splats->log_scale.col(i)) {
    if (scale < -kMostLogScale) scale = -kMostLogScale;
  }
  float& logit = splats->logit[i];
  if (std::abs(logit) > kMostLogit) logit = std::copysign(kMostLogit, logit);
}

void Check(const std::string& path, int i, const Splats& splats) {
  const auto fail = [&](const char* what) {
    FailPly(path, fmt::format("splat {} has {}", i, what));
  };
  const auto within = [](const auto& numbers, float most) {
    return (numbers.array().abs() <= most).all();  // false for NaN
  };
  if (!within(splats.position.col(i), kFarthest)) fail("a position that is not finite, or far off");
  if (!within(splats.log_scale.col(i), kMostLogScale))
    fail("a scale that is not a number, or huge");
  if (!within(splats.logit.segment<1>(i), kMostLogit)) fail("an opacity that is not a number");
  if (!within(splats.harmonics.col(i), kMostColour)) fail("a colour that is not finite, or huge");
  constexpr float kLeast = 1e-6F;
  const float length = splats.rotation.col(i).norm();
  if (!(length >= kLeast && length <= 1 / kLeast)) fail("a rotation that is none");
}

void AppendFloat(float number, std::string* bytes) {
  std::array<char, sizeof(float)> raw;
  std::memcpy(raw.data(), &number, sizeof(float));
  bytes->append(raw.data(), raw.size());
}

}  // namespace

Splats ReadSplats(const std::string& path) {
  const std::string bytes = ReadFile(path, kMostBytes);
  const PlyHeader header = ReadPlyHeader(path, bytes);
  const int degree = DegreeOf(path, header);
  const std::vector<std::size_t> places = PlacesOf(path, header, degree);
  const auto rows = static_cast<std::size_t>(header.count), there = bytes.size() - header.start;
  if (there / header.stride < rows) {
    FailPly(path, fmt::format("is cut short: {} splats of {} bytes, but {} bytes are there", rows,
                              header.stride, there));
  }
  Splats splats;
  splats.Resize(static_cast<int>(rows), degree);
  std::vector<float> numbers(places.size());
  for (int i = 0; i < splats.count(); ++i) {
    const char* row = bytes.data() + header.start + i * header.stride;
    for (std::size_t k = 0; k < places.size(); ++k) {
      std::memcpy(&numbers[k], row + places[k], sizeof(float));
    }
    Put(numbers, i, &splats);
    Bound(i, &splats);
    Check(path, i, splats);
  }
  return splats;
}

void WriteSplats(const Splats& splats, const std::string& path) {
  const int rest = HarmonicCount(splats.degree) - 1;
  std::string text =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", splats.count());
  const auto property = [&text](const std::string& name) {
    text += "property float " + name + "\n";
  };
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) property(name);
  for (int k = 0; k < 3; ++k) property(fmt::format("f_dc_{}", k));
  for (int k = 0; k < 3 * rest; ++k) property(fmt::format("f_rest_{}", k));
  property("opacity");
  for (int k = 0; k < 3; ++k) property(fmt::format("scale_{}", k));
  for (int k = 0; k < 4; ++k) property(fmt::format("rot_{}", k));
  text += "end_header\n";
  const auto append = [&text](const auto& column) {
    for (const float x : column) AppendFloat(x, &text);
  };
  for (int i = 0; i < splats.count(); ++i) {
    append(splats.position.col(i));
    append(Eigen::Vector3f::Zero().eval());
    for (int c = 0; c < 3; ++c) AppendFloat(splats.harmonics(c * (rest + 1), i), &text);
    for (int c = 0; c < 3; ++c) append(splats.harmonics.col(i).segment(c * (rest + 1) + 1, rest));
    AppendFloat(splats.logit[i], &text);
    append(splats.log_scale.col(i));
    append(splats.rotation.col(i));
  }
  WriteFileAtomically(path, text);
}

}  // namespace physpring
