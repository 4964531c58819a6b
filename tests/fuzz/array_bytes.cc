// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/array_bytes.h"

#include <algorithm>
#include <array>

#include "twin/npy.h"

namespace physpring {
namespace {

constexpr std::array<const char*, 12> kTypes{"<f2", "<f4", "<f8", "|i1", "<i2", "<i4",
                                             "<i8", "|u1", "<u2", "<u4", "<u8", "|b1"};
constexpr std::size_t kLarge = 65535, kLargestExtent = 2147483647, kMostValues = 4096;
constexpr std::size_t kMostDimensions = 5;

// Takes bytes from the front; zeros where there are no more.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : rest_(bytes) {}

  bool empty() const { return rest_.empty(); }

  std::size_t Byte() {
    const std::string_view byte = Bytes(1);
    return byte.empty() ? 0 : static_cast<unsigned char>(byte[0]);
  }

  std::size_t Extent() {
    const std::size_t low = Byte(), extent = low | Byte() << 8;
    return extent == kLarge ? kLargestExtent : extent;
  }

  std::string_view Bytes(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(taken.size());
    return taken;
  }

 private:
  std::string_view rest_;
};

}  // namespace

Npz ArraysOf(std::string_view bytes) {
  Npz arrays;
  Taker taker(bytes);
  while (!taker.empty()) {
    const std::string name(taker.Bytes(taker.Byte()));
    NpzArray array{kTypes[taker.Byte() % kTypes.size()], {}, {}};
    array.shape.resize(taker.Byte() % (kMostDimensions + 1));
    for (std::size_t& extent : array.shape) extent = taker.Extent();
    const std::size_t count = CountOfShape(array.shape).value_or(kMostValues + 1);
    if (count > kMostValues) continue;
    const std::string_view values = taker.Bytes(count * BytesOfType(array.type));
    array.data.assign(values.begin(), values.end());
    array.data.resize(count * BytesOfType(array.type));
    arrays.emplace(name, array);
  }
  return arrays;
}

std::string BytesOf(const Npz& arrays) {
  std::string bytes;
  for (const auto& [name, array] : arrays) {
    const auto type = std::find(kTypes.begin(), kTypes.end(), array.type) - kTypes.begin();
    bytes += static_cast<char>(name.size());
    bytes += name;
    bytes += static_cast<char>(type);
    bytes += static_cast<char>(array.shape.size());
    for (const std::size_t extent : array.shape) {
      bytes += static_cast<char>(extent & 255);
      bytes += static_cast<char>(extent >> 8);
    }
    bytes.append(array.data.begin(), array.data.end());
  }
  return bytes;
}

}  // namespace physpring
